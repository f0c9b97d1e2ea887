# One file of the page: style, script and module in its text. cmake -D TEMPLATE= STYLES= SCRIPT= PAGE= -P bundle.cmake
file(READ "${REPORT_STYLE}" STYLE)
string(REGEX REPLACE ".*R\"css\\(" "" STYLE "${STYLE}")
string(REGEX REPLACE "\\)css\".*" "" STYLE "${STYLE}")
file(READ "${OWN_STYLE}" own)
string(APPEND STYLE "${own}")
file(READ "${SCRIPT}" SCRIPT)
configure_file("${TEMPLATE}" "${PAGE}" @ONLY)
