# Writes a C++ source with every shader as a string: cmake -DSHADERS=DIR -DOUTPUT=FILE -P embed_shaders.cmake
# A line `#include "name.glsl"` is replaced by that file, so that programs share the sea and the light.

function(expand_includes file out)
    file(READ ${SHADERS}/${file} text)
    string(REGEX MATCHALL "#include \"[a-z_.]+\"\n" includes "${text}")
    foreach(line ${includes})
        string(REGEX REPLACE "#include \"(.*)\"\n" "\\1" name "${line}")
        expand_includes(${name} inner)
        string(REPLACE "${line}" "${inner}" text "${text}")
    endforeach()
    set(${out} "${text}" PARENT_SCOPE)
endfunction()

file(GLOB stages RELATIVE ${SHADERS} ${SHADERS}/*.vert ${SHADERS}/*.tesc ${SHADERS}/*.tese ${SHADERS}/*.geom ${SHADERS}/*.frag)
set(result "#include \"client/gpu/shader_sources.hpp\"\n\nnamespace trochoid {\n\n")
string(APPEND result "const std::map<std::string_view, std::string_view>& shader_sources() {\n")
string(APPEND result "    static const std::map<std::string_view, std::string_view> sources{\n")
foreach(stage ${stages})
    expand_includes(${stage} text)
    string(APPEND result "        {\"${stage}\", R\"glsl(${text})glsl\"},\n")
endforeach()
string(APPEND result "    };\n    return sources;\n}\n\n}  // namespace trochoid\n")
file(WRITE ${OUTPUT} "${result}")
