# Fails unless the README shows quick_start.cpp as it is, below the comment on its first line.

file(READ ${README} readme)
file(READ ${PROGRAM} program)
string(REGEX REPLACE "^//[^\n]*\n\n" "" program "${program}")
string(FIND "${readme}" "```cpp\n${program}```" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${README} does not show ${PROGRAM} as it is")
endif()
