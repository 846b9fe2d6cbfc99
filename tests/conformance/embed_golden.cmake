# cmake -DMESSAGES=wire_messages.txt -DOUT=header -P embed_golden.cmake: the file's text as string literals in pieces of 8,000
# characters (compilers need only take 65,536).
file(READ ${MESSAGES} content)
string(LENGTH "${content}" length)
set(text "")
set(at 0)
while(at LESS length)
    string(SUBSTRING "${content}" ${at} 8000 piece)
    string(APPEND text "R\"golden(${piece})golden\",\n")
    math(EXPR at "${at} + 8000")
endwhile()
file(WRITE ${OUT} "#pragma once\n\nnamespace trochoid::conformance::golden_text {\n\ninline constexpr const char* wire_messages[] = {\n${text}};\n\n}  // namespace trochoid::conformance::golden_text\n")
