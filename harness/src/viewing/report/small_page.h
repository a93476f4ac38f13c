// The frame of pages that need no recording: the index of tests, a history, a campaign. Internal.
#pragma once

#include <string>
#include <string_view>

namespace rehearse {

struct SmallPage {
  std::string_view magic;     // the first line, by which the file is known
  std::string kind;           // the word in front of the title: "Tests"
  bool is_bad = false;        // whether the word is red, or else green
  std::string title;          // a sentence
  std::string sentence = {};  // what follows it; may be empty
  std::string content;        // HTML below the head
};

/// The page: one file with the style sheets of reports, themes, keys and their help.
std::string small_page(const SmallPage& page);

/// The style and the script that are part of each page (small_page_parts.cpp.in).
std::string_view small_page_style();
std::string_view small_page_script();

}  // namespace rehearse
