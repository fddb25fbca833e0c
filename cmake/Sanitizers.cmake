# tufa_sanitizers: a private interface target with the sanitizers named in TUFA_SANITIZE.

add_library(tufa_sanitizers INTERFACE)
if(TUFA_SANITIZE)
  target_compile_options(tufa_sanitizers INTERFACE
    -fsanitize=${TUFA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(tufa_sanitizers INTERFACE -fsanitize=${TUFA_SANITIZE})
endif()
