#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// One structure of a label map: the voxels of `value` in `layer`.
struct Segment {
  std::string name;  ///< UTF-8 without control characters; empty where the map gives none
  int value = 0;
  std::size_t layer = 0;  ///< its layer in the file: structures that overlap lie in several
  std::optional<std::array<std::uint8_t, 3>> colour{};
  std::string terminology{};  ///< 3D Slicer's codes, as it writes them
};

/// The names and other properties of a label map's labels, beside its voxels. One without names has no segments.
struct Segmentation {
  std::vector<Segment> segments;  ///< by layer and value, one of each
  std::string unread{};           ///< the file of names beside the map that is damaged, and its fault; else empty

  /// Null where nothing is said of it.
  const Segment* find(int value, std::size_t layer) const;
  /// Returns the first of that value, of whatever layer.
  const Segment* find(int value) const;
  /// Puts one in its place; false where there is one of that layer and value, and beyond 16,384, which no atlas has.
  bool add(Segment segment);
};

/// The colour of a structure to which the map gives none: by its name one of twelve, which people who confuse colours
/// tell apart too. Structures that are often in one map, neighbouring vertebrae and neighbours in a numbered row have
/// unlike ones. The left one of a pair is lighter, the right one darker.
std::array<std::uint8_t, 3> colour_by_name(const std::string& name);

/// Gives the segments of a map that have a name and no colour that of their name; where several would have one, others
/// get one of their own, as far as 36 colours reach. The same names give the same colours, in any order.
void colour_by_names(Segmentation& segmentation);

/// "label 3", or "label 3 (spleen)" where it has a name.
std::string label_words(const Segment& segment);

/// Text from another program as a name: what is no UTF-8 is taken for Latin-1, and control characters become '?'.
std::string segment_name(std::string_view text);

/// How alike a segment's name and another are.
enum class NameLikeness {
  none,
  words,  ///< the same words in any order, with blanks, '_', '-' or '.' between them: "Left kidney" and "kidney_left"
  any_case,
  same
};
NameLikeness name_likeness(const std::string& a, const std::string& b);

/// The segments that `--label` and the columns of tables ask for: a value above 0, a name, or several of both,
/// separated by commas. For a name those segments count that are likest [NameLikeness]. A value of which nothing is
/// said is a segment without a name. Errors: a name that the map lacks (the nearest ones are named) or gives to
/// several; a value that stands in several layers.
Result<std::vector<Segment>> asked_segments(const std::string& asked, const Segmentation& known);

/// Whether text is made of numbers, so that it is no name, and not of values above 0 with commas between them.
bool is_bad_label(const std::string& asked);

}  // namespace homolog
