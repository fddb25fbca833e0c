# tufa_warnings: a private interface target with the warnings that all own code is built with, and the
# options that its results depend on.

include(CheckCXXCompilerFlag)

add_library(tufa_warnings INTERFACE)
target_compile_options(tufa_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wcast-align -Woverloaded-virtual
  -Wold-style-cast -Wconversion -Wno-sign-conversion -Wunused-const-variable
  # The same bytes everywhere: no fused multiply-add that one compiler makes and another does not.
  -ffp-contract=off
  # Square roots may be parts of vectorized loops; nothing reads errno after them.
  -fno-math-errno)
# With link-time optimization, this analysis of GCC 12 lets stores be dropped that a function reads
# through a reference: distances in the certificate came out wrong, and --fast gave the uniform mesh.
check_cxx_compiler_flag(-fno-ipa-modref TUFA_HAS_NO_IPA_MODREF)
if(TUFA_HAS_NO_IPA_MODREF)
  target_compile_options(tufa_warnings INTERFACE -fno-ipa-modref)
endif()
if(TUFA_WARNINGS_AS_ERRORS)
  target_compile_options(tufa_warnings INTERFACE -Werror)
endif()
