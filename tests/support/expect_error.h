#pragma once

#include <gtest/gtest.h>

#include <tufa/error.h>
#include <string>

namespace tufa::test {

/// Expects that `work` throws an Error with that code, in one line that holds `part`.
template <class Work>
void expectError(ErrorCode code, const std::string& part, Work&& work) {
  try {
    work();
    ADD_FAILURE() << "no error, though one about \"" << part << "\" was due";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.code(), code) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace tufa::test
