#include "core/base/text/text.h"

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/base/files/file_stem.h"

namespace homolog {

TEST_CASE("a file's name loses the ending of its format and no other dots") {
  for (const auto& [name, stem] :
       std::vector<std::pair<std::string, std::string>>{{"ct.nii.gz", "ct"},
                                                        {"CT.NII.GZ", "CT"},
                                                        {"sub.01.nii.gz", "sub.01"},
                                                        {"sub.02.nii", "sub.02"},
                                                        {"organ.seg.nrrd", "organ"},
                                                        {"v1.2.seg.nrrd", "v1.2"},
                                                        {"kidney 1.2.homolog", "kidney 1.2"},
                                                        {"points.mrk.json", "points"},
                                                        {"all.study.json", "all"},
                                                        {"femur.h5.json", "femur"},
                                                        {"1.2.840.113619.2", "1.2.840.113619.2"},
                                                        {"a.b.c", "a.b.c"},
                                                        {".nii.gz", ".nii"},
                                                        {"", ""}}) {
    CAPTURE(name);
    CHECK(file_stem("some.folder/" + name) == stem);
  }
}

TEST_CASE("blanks around a text are taken off and only whole texts are numbers") {
  CHECK(trimmed(" \t a b\r\n") == "a b");
  CHECK(trimmed(" \t\r\n").empty());
  CHECK(as_number<int>("-12") == -12);
  CHECK(as_number<double>("2.5e1") == 25);
  for (const char* text : {"", " 1", "1 ", "+1", "1.0", "1x", "99999999999"}) CHECK_FALSE(as_number<int>(text));
}

TEST_CASE("a line of a table is cut at its separator but not within quotes") {
  using Cells = std::vector<std::string>;
  CHECK(table_separator("a,b;c\td") == ',');
  CHECK(table_separator("a;b\tc") == '\t');
  CHECK(table_separator("a;b") == ';');
  CHECK(table_separator("a") == ',');
  CHECK(csv_fields(R"(a, "b,""c""" ,)") == Cells{"a", R"( b,"c" )", ""});
  CHECK(table_cells("a; \"b;c\" ;d\r", ';') == Cells{"a", "b;c", "d"});
}

TEST_CASE("bytes that are no UTF-8 are known as such") {
  for (const char* text : {"", "plain", "Öffnung", "心", "\xf0\x9f\xab\x80"}) CHECK(is_utf8(text));
  for (const char* text :
       {"caf\xe9", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xff", "\xe2\x82", "a\x80"})
    CHECK_FALSE(is_utf8(text));
}

}  // namespace homolog
