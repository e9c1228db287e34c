#pragma once

#include <string>
#include <vector>

#include "tests/core/volume/dicom_slices.h"

// Structure sets (RTSTRUCT) of a few contours, byte by byte.

namespace homolog {

struct ContourItem {
  int roi = 1;
  std::string kind, points;
};

/// A structure set; members that tests change.
struct RtFile {
  std::string space = "1.2.9";
  std::vector<std::string> names{"spleen"};
  std::vector<ContourItem> drawn;
  std::string series{};  ///< that it was drawn on; empty: it names none

  std::string bytes() const {
    std::string rois, contours;
    for (std::size_t r = 0; r < names.size(); ++r) {
      const std::string number = std::to_string(r + 1);
      rois += item(element(0x30060022, "IS", number) + (space.empty() ? "" : element(0x30060024, "UI", space)) +
                   element(0x30060026, "LO", names[r]));
    }
    for (const ContourItem& one : drawn)
      contours +=
          item(element(0x3006002a, "IS", "255\\128\\0") +
               sequence(0x30060040, item(element(0x30060042, "CS", one.kind) + element(0x30060050, "DS", one.points))) +
               element(0x30060084, "IS", std::to_string(one.roi)));
    const std::string drawn_on =
        series.empty()
            ? std::string()
            : sequence(0x30060010,
                       item(sequence(0x30060012, item(sequence(0x30060014, item(element(0x0020000e, "UI", series)))))));
    const std::string data = element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.481.3") +
                             element(0x00080060, "CS", "RTSTRUCT") + drawn_on + sequence(0x30060020, rois) +
                             sequence(0x30060039, contours);
    const std::string meta = element(0x00020010, "UI", "1.2.840.10008.1.2.1");
    return std::string(128, '\0') + "DICM" +
           element(0x00020000, "UL", little_endian(static_cast<std::uint32_t>(meta.size()), 4)) + meta + data;
  }
};

}  // namespace homolog
