#pragma once
#include "partition/types.hpp"

#include <string_view>

namespace taut {

/// Walks through a text in memory by lines and, within a line, by words. A comment (#) ends its line; a
/// backslash at the end of a line joins the next one to it; lines may end in LF or CR LF.
class TextScanner {
public:
  explicit TextScanner(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  /// The next word of the line, empty at its end.
  std::string_view next_word() {
    skip_blanks();
    const char* const begin = at_;
    while (at_ != end_ && !is_blank(*at_) && *at_ != '\n' && *at_ != '#' && !joins_next_line()) ++at_;
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }

  /// Goes to the next line, over what is left of this one; false at the end of the text.
  bool next_line() {
    if (line_ > 0) skip_rest();
    first_line_ = ++line_;
    return at_ != end_;
  }

  /// 1-based number of the line; of a joined one, where it begins.
  Global line() const { return first_line_; }

private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

  bool joins_next_line() const {
    if (*at_ != '\\') return false;
    const char* next = at_ + 1;
    if (next != end_ && *next == '\r') ++next;
    return next != end_ && *next == '\n';
  }

  void skip_blanks() {
    for (; at_ != end_; ++at_) {
      if (joins_next_line()) {
        while (*at_ != '\n') ++at_;
        ++line_;
      } else if (!is_blank(*at_)) {
        return;
      }
    }
  }

  void skip_rest() {
    while (!next_word().empty()) {
    }
    while (at_ != end_ && *at_ != '\n') ++at_; // a comment
    if (at_ != end_) ++at_;
  }

  const char* at_;
  const char* end_;
  Global line_ = 0;       ///< where `at_` is
  Global first_line_ = 0; ///< where the line began
};

} // namespace taut
