#A test : every program answers-- help, refuses what it does not know, and stops cleanly at SIGTERM.
#
#cmake - D "PROGRAMS=path|exit at SIGTERM|arguments;..." - P programs.cmake
#
#Exit at SIGTERM : 130 of a job, 0 of a server, `-` of a program that is done before one could send it.
cmake_minimum_required(VERSION 3.25) find_program(TIMEOUT timeout REQUIRED) set(failed "") foreach (
    entry IN LISTS PROGRAMS) string(REPLACE
                                    "|"
                                    ";" entry "${entry}") list(GET entry 0 program)
    list(GET entry 1 at_signal) list(LENGTH entry length) set(arguments "") if (length GREATER 2) list(
        GET entry 2 arguments) separate_arguments(arguments) endif() get_filename_component(name
                                                                                            "${program}" NAME)

        execute_process(COMMAND "${TIMEOUT}" -
                        k 1 60 "${program}" --help RESULT_VARIABLE code OUTPUT_VARIABLE said ERROR_VARIABLE
                            said) if (NOT code EQUAL 0 OR NOT said MATCHES "${name}|Usage|OPTIONS")
            list(APPEND failed "${name} --help: exit ${code}") endif() execute_process(
                COMMAND "${TIMEOUT}" - k 1 60 "${program}" --no - such -
                option RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE
                    said) if (NOT code EQUAL 2 OR said STREQUAL
                              "") list(APPEND failed
                                       "${name} --no-such-option: exit ${code} instead of 2 with words")
                endif() if (at_signal STREQUAL "-") message(STATUS "${name}: --help") continue() endif()
#A machine that is busy may take long until a program listens to signals : then it dies of this one, \
    and is tried again.
                    foreach (wait IN ITEMS 1 5 20) set(after ${wait}) execute_process(
                        COMMAND
                        "${TIMEOUT}" --preserve -
                        status - s TERM -
                        k 30 $ { after } "${program}" ${
                            arguments} RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE
                            said) if (NOT code EQUAL 143) break() endif() endforeach()
                        message(STATUS "${name}: --help, SIGTERM after ${after} s: exit ${code}") if (
                            NOT code EQUAL at_signal) string(REPLACE
                                                             ";"
                                                             "," said
                                                             "${said}") list(JOIN arguments " " words)
                            list(APPEND failed
                                 "${name} ${words}: exit ${code} at SIGTERM instead of ${at_signal}\n${said}")
                                endif() endforeach() if (failed) list(JOIN failed "\n  " failed)
                                    message(FATAL_ERROR "\n  ${failed}") endif()
