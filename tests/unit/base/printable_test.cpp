#include "base/printable.h"

#include <gtest/gtest.h>

#include <tufa/error.h>

namespace tufa::base {
namespace {

TEST(Printable, KeepsWhatIsShown) {
  for (const char* text : {"", "plain text.", "a \"b\" \\ c", "Körper", "体积", "🙂", "é"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, EscapesWhatATerminalObeys) {
  EXPECT_EQ(printable("\x1b[31m"), R"(\x1b[31m)");
  EXPECT_EQ(printable("a\nb\r\tc\x7f"), R"(a\x0ab\x0d\x09c\x7f)");
  EXPECT_EQ(printable(std::string("a\0b", 3)), R"(a\x00b)");
  EXPECT_EQ(printable("\xc2\x9b"
                      "1m"),
            R"(\xc2\x9b1m)");                               // the escape of 8 bits, as UTF-8
  EXPECT_EQ(printable("\xe2\x80\xae"), R"(\xe2\x80\xae)");  // from right to left
  EXPECT_EQ(printable("\xe2\x80\xa8"), R"(\xe2\x80\xa8)");  // the end of a line
}

TEST(Printable, EscapesBytesThatAreNoCharacter) {
  EXPECT_EQ(printable("\x9b"
                      "1m"),
            R"(\x9b1m)");
  EXPECT_EQ(printable("K\xf6rper"), R"(K\xf6rper)");  // Latin-1
  EXPECT_EQ(printable("\xc0\x8a"), R"(\xc0\x8a)");    // a new line, too long
  EXPECT_EQ(printable("\xe0\x80\x8a"), R"(\xe0\x80\x8a)");
  EXPECT_EQ(printable("\xed\xa0\x80"), R"(\xed\xa0\x80)");  // half of a pair
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), R"(\xf4\x90\x80\x80)");
  EXPECT_EQ(printable("\xe4\xbd"), R"(\xe4\xbd)");  // cut short
}

TEST(Printable, MessagesOfErrorsAreOneLine) {
  EXPECT_STREQ(Error(ErrorCode::UnreadableFile, "grid \"a\nb\"").what(), R"(grid "a\x0ab")");
}

}  // namespace
}  // namespace tufa::base
