# How every folder is built: one static library per folder; LINKS is the arrow of the architecture.
# The rules of floating point stand here once: no contraction, no fast-math, SSE rather than x87.

add_library(trochoid_rules INTERFACE)
target_include_directories(trochoid_rules INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(trochoid_rules INTERFACE TROCHOID_VERSION="${PROJECT_VERSION}")
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(trochoid_rules INTERFACE -ffp-contract=off)
    # gcc 12 joins a product with an alternating add and subtract into one fused vfmaddsub where the target has FMA,
    # -ffp-contract=off or not (seen at a turn of axes with -march=native); it needs the straight-line vectoriser for that.
    target_compile_options(trochoid_rules INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(i[3-6]86|x86)$")
        target_compile_options(trochoid_rules INTERFACE -msse2 -mfpmath=sse)
    endif()
    target_compile_options(trochoid_rules INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
        # gcc 12 warns falsely of std::string concatenation (gcc bug 105651).
        target_compile_options(trochoid_rules INTERFACE -Wno-restrict)
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
        # libstdc++ 12's own stable_sort uses what it has deprecated, and says so to newer clangs.
        target_compile_options(trochoid_rules INTERFACE -Wno-deprecated-declarations)
    endif()
    if(TROCHOID_WERROR)
        target_compile_options(trochoid_rules INTERFACE -Werror)
    endif()
    if(TROCHOID_SANITIZE)
        target_compile_options(trochoid_rules INTERFACE -fsanitize=${TROCHOID_SANITIZE} -fno-omit-frame-pointer
                                                        -fno-sanitize-recover=all)
        target_link_options(trochoid_rules INTERFACE -fsanitize=${TROCHOID_SANITIZE})
        if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
            # Asio's fences: gcc warns that ThreadSanitizer cannot see them, and of false positives under sanitizers.
            target_compile_options(trochoid_rules INTERFACE -Wno-error=tsan -Wno-error=maybe-uninitialized
                                                            -Wno-error=array-bounds -Wno-error=stringop-overflow)
        endif()
    endif()
elseif(MSVC)
    target_compile_options(trochoid_rules INTERFACE /fp:precise /W4 /permissive-)
endif()

# trochoid_library(name SOURCES a.cpp … LINKS protocol_units …): the static library of one folder.
# A folder without sources of its own gives an interface library.
function(trochoid_library name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
    if(ARG_SOURCES)
        add_library(${name} STATIC ${ARG_SOURCES})
        target_link_libraries(${name} PUBLIC trochoid_rules ${ARG_LINKS})
    else()
        add_library(${name} INTERFACE)
        target_link_libraries(${name} INTERFACE trochoid_rules ${ARG_LINKS})
    endif()
endfunction()

# trochoid_program(trochoid-name SOURCES main.cpp LINKS …): a program in <build>/bin.
function(trochoid_program name)
    cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE trochoid_rules ${ARG_LINKS})
endfunction()

# trochoid_test(name SOURCES … LINKS … [LABEL quick] [TIMEOUT 60]): a GoogleTest program, one ctest entry.
function(trochoid_test name)
    cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;LINKS" ${ARGN})
    if(NOT ARG_LABEL)
        set(ARG_LABEL quick)
    endif()
    if(NOT ARG_TIMEOUT)
        set(ARG_TIMEOUT 120)
    endif()
    if(TROCHOID_SANITIZE)
        math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 2")
    endif()
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE trochoid_rules ${ARG_LINKS} GTest::gtest GTest::gtest_main Threads::Threads)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
    target_compile_definitions(${name} PRIVATE TROCHOID_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                               TROCHOID_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
