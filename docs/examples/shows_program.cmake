# cmake -DPAGE=... -DPROGRAM=... -DSKIP=REGEX -P shows_program.cmake: fails unless a page shows a
# program as it is, but for what SKIP matches at its beginning.

file(READ ${PAGE} page)
file(READ ${PROGRAM} program)
string(REGEX REPLACE "^${SKIP}" "" program "${program}")
string(FIND "${page}" "```cpp\n${program}```" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${PAGE} does not show ${PROGRAM} as it is")
endif()
