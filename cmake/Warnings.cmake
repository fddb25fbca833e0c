# tufa_warnings: a private interface target with the warnings that all own code is built with.

add_library(tufa_warnings INTERFACE)
target_compile_options(tufa_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wcast-align -Woverloaded-virtual
  -Wold-style-cast -Wconversion -Wno-sign-conversion -Wunused-const-variable
  # The same bytes everywhere: no fused multiply-add that one compiler makes and another does not.
  -ffp-contract=off
  # Square roots may be parts of vectorized loops; nothing reads errno after them.
  -fno-math-errno)
if(TUFA_WARNINGS_AS_ERRORS)
  target_compile_options(tufa_warnings INTERFACE -Werror)
endif()
