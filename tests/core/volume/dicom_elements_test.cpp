#include "core/volume/dicom/dicom_elements.h"

#include <doctest/doctest.h>

#include <string>

#include "tests/refusal.h"

using namespace homolog;

TEST_CASE("an element that is longer than its length can say is refused and not cut short") {
  const std::string longest(65534, 'a'), longer(65535, 'a');
  DicomElements data;
  data.put(0x00100010, "PN", longest).put(0x7fe00010, "OB", longer + longer);
  CHECK(data.check());
  CHECK(data.bytes().substr(0, 10) == std::string("\x10\0\x10\0PN\xfe\xff"
                                                  "aa",
                                                  10));
  data.put(0x00100020, "LO", longer);
  CHECK(says(data.check(), "(0010,0020) is longer than DICOM allows"));
  DicomElements around;
  CHECK(around.check());
  around.put_items(0x00620002, {data});
  CHECK(says(around.check(), "(0010,0020) is longer than DICOM allows"));
}
