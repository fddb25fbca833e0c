# tufa_sanitizers: a private interface target with the sanitizers named in TUFA_SANITIZE.

add_library(tufa_sanitizers INTERFACE)
if(TUFA_SANITIZE)
  target_compile_options(tufa_sanitizers INTERFACE
    -fsanitize=${TUFA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    $<$<CXX_COMPILER_ID:Clang>:-fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/tests/sanitizers-ignored.txt>)
  if(TUFA_SANITIZE MATCHES address)
    # AddressSanitizer stops at null pointers and behind objects by itself: these checks would be a
    # tenth of what is compiled.
    target_compile_options(tufa_sanitizers INTERFACE -fno-sanitize=null,object-size)
  endif()
  if(TUFA_SANITIZE MATCHES thread)
    target_compile_definitions(tufa_sanitizers INTERFACE TUFA_THREAD_SANITIZER)
  endif()
  target_link_options(tufa_sanitizers INTERFACE -fsanitize=${TUFA_SANITIZE})
endif()
