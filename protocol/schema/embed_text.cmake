# cmake -DFILES=a;b -DOUT=header -P embed_text.cmake: the files' text as raw string literals, one a file.
set(text "#pragma once\n\nnamespace trochoid::wire_fb {\n\ninline constexpr const char* schema_text[] = {\n")
foreach(file ${FILES})
    file(READ ${file} content)
    string(APPEND text "R\"schema(${content})schema\",\n")
endforeach()
string(APPEND text "};\n\n}  // namespace trochoid::wire_fb\n")
file(WRITE ${OUT} "${text}")
