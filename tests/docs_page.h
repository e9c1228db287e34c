#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "core/base/files/files.h"
#include "tests/must.h"

namespace homolog::test {

/// A page of docs/ that holds tables made from the code.
class DocsPage {
 public:
  explicit DocsPage(std::string name)
      : name_(std::move(name)),
        text_(must(read_whole_file(std::filesystem::path(HOMOLOG_SOURCE_DIR) / "docs" / name_))),
        made_(text_) {}

  /// A table, with a line break behind each row, that belongs in the place of the one with the same first row.
  void has_table(const std::string& table) {
    const auto begin = made_.find(table.substr(0, table.find('\n') + 1)), end = made_.find("\n\n", begin);
    REQUIRE(begin != std::string::npos);
    REQUIRE(end != std::string::npos);
    made_.replace(begin, end + 1 - begin, table);
  }

  /// Fails where the page is another; what it should be is left in the build folder.
  void check() const {
    if (made_ == text_) return;
    const std::filesystem::path left = std::filesystem::path(HOMOLOG_BINARY_DIR) / name_;
    REQUIRE(write_whole_file(left, made_));
    FAIL("docs/" << name_ << " says otherwise than the code that it is made from. What it should be is in "
                 << left.string() << "; look at it and copy it to docs/" << name_ << ".");
  }

 private:
  std::string name_, text_, made_;
};

}  // namespace homolog::test
