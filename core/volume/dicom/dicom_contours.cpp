#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "core/base/text/listed.h"
#include "core/base/text/text.h"
#include "core/volume/contours.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/dicom/dicom_text.h"
#include "core/volume/labels/segmentation.h"
#include "core/volume/referenced_images.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

namespace rt {
constexpr DicomTag storage = 0x00080016, study_uid = 0x0020000d, instance = 0x00081155, images = 0x30060016,
                   modality = 0x00080060, series_uid = 0x0020000e, space = 0x00200052, spaces = 0x30060010,
                   studies = 0x30060012, series = 0x30060014, rois = 0x30060020, number = 0x30060022,
                   space_of_roi = 0x30060024, name = 0x30060026, colour = 0x3006002a, drawn = 0x30060039,
                   contours = 0x30060040, kind = 0x30060042, count = 0x30060046, points = 0x30060050,
                   observations = 0x30060080, of_roi = 0x30060084, type = 0x300600a4, offset = 0x30060045;
}  // namespace rt

bool is_structure_set(const DicomSet& set) {
  return text_of(set.elements, rt::storage) == "1.2.840.10008.5.1.4.1.1.481.3" ||
         text_of(set.elements, rt::modality) == "RTSTRUCT";
}

/// Calls `see(item)` for the items of a sequence.
template <class See>
void for_each_item(const DicomItem& item, DicomTag sequence, const See& see) {
  if (const auto found = item.find(sequence); found != item.end())
    for (const DicomItem& one : found->second.items) see(one);
}

std::optional<int> whole_number(const DicomItem& item, DicomTag tag) {
  const auto number = number_of(item, tag);
  if (!number || *number != std::rint(*number) || std::abs(*number) > 2147483647) return {};
  return static_cast<int>(*number);
}

std::optional<std::array<std::uint8_t, 3>> roi_colour(const DicomItem& item) {
  const auto numbers = numbers_of(item, rt::colour);
  if (numbers.size() != 3) return {};
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>(std::clamp(numbers[c], 0.0, 255.0));
  return colour;
}

/// The spaces in which the structures are given.
std::set<std::string> spaces_of(const DicomItem& data) {
  std::set<std::string> spaces;
  for_each_item(data, rt::rois, [&](const DicomItem& item) { spaces.insert(text_of(item, rt::space_of_roi)); });
  spaces.erase("");
  if (spaces.empty())
    for_each_item(data, rt::spaces, [&](const DicomItem& item) { spaces.insert(text_of(item, rt::space)); });
  spaces.erase("");
  if (const std::string whole = text_of(data, rt::space); spaces.empty() && !whole.empty()) spaces.insert(whole);
  return spaces;
}

ReferencedImages drawn_images(const DicomItem& data) {
  ReferencedImages drawn;
  drawn.study = text_of(data, rt::study_uid);
  const auto add = [&](const DicomItem& item) {
    for_each_item(item, rt::images, [&](const DicomItem& image) {
      if (std::string uid = text_of(image, rt::instance); !uid.empty()) drawn.instances.push_back(std::move(uid));
    });
  };
  for_each_item(data, rt::spaces, [&](const DicomItem& space) {
    for_each_item(space, rt::studies, [&](const DicomItem& study) {
      for_each_item(study, rt::series, [&](const DicomItem& series) {
        if (std::string uid = text_of(series, rt::series_uid); !uid.empty()) drawn.series.push_back(std::move(uid));
        add(series);
      });
    });
  });
  for_each_item(data, rt::drawn, [&](const DicomItem& roi) { for_each_item(roi, rt::contours, add); });
  return drawn;
}

/// The structures as they are described, without contours. `warnings`: names that cannot be read.
Result<std::vector<ContourRoi>> described_rois(const DicomSet& set, std::vector<std::string>& warnings) {
  const DicomAlphabets alphabets(set.elements);
  bool unread = false;
  std::vector<ContourRoi> rois;
  std::set<int> numbers;
  bool numbered = true;
  for_each_item(set.elements, rt::rois, [&](const DicomItem& item) {
    const auto number = whole_number(item, rt::number);
    numbered = numbered && number && numbers.insert(*number).second;
    rois.push_back({.name = alphabets.name_of(item, rt::name, unread), .number = number.value_or(0), .type = {}});
  });
  if (!numbered) return fail(set.path.string(), "describes structures without a number of their own; export it again");
  if (rois.empty()) return fail(set.path.string(), "describes no structures; export it again");
  for_each_item(set.elements, rt::observations, [&](const DicomItem& item) {
    const auto number = whole_number(item, rt::of_roi);
    for (ContourRoi& roi : rois)
      if (number == roi.number) roi.type = segment_name(text_of(item, rt::type));
  });
  std::sort(rois.begin(), rois.end(), [](const ContourRoi& a, const ContourRoi& b) { return a.number < b.number; });
  if (unread) warnings.push_back(unread_names(set.path.string(), alphabets));
  return rois;
}

/// The contours of a structure that are not taken as they stand.
struct OddContours {
  std::vector<std::size_t> keys;  ///< of those that were taken [key_of]
  int doubled = 0, short_ones = 0, moved = 0;
  std::string unknown_kind;
  int of_unknown_kind = 0;

  std::vector<std::string> doubts() const {
    const auto contours = [](int count) { return std::to_string(count) + (count == 1 ? " contour" : " contours"); };
    std::vector<std::string> all;
    if (doubled > 0) all.push_back(contours(doubled) + " twice; one of each was taken");
    if (short_ones > 0)
      all.push_back(contours(short_ones) + " of fewer than three points, which hold nothing; they were left out");
    if (of_unknown_kind > 0)
      all.push_back(contours(of_unknown_kind) +
                    (unknown_kind.empty() ? std::string(" of no kind")
                                          : " of the kind " + excerpt(unknown_kind) + ", which is not known") +
                    "; closed ones were assumed");
    if (moved > 0)
      all.push_back(contours(moved) +
                    " with an offset (Contour Offset Vector), which was not applied; check the place");
    return all;
  }
};

/// The image that a contour was drawn on [named_image]; empty where it names none, or several.
std::string image_of(const DicomItem& item) {
  std::set<std::string> names;
  for_each_item(item, rt::images, [&](const DicomItem& image) { names.insert(named_image(image)); });
  return names.size() == 1 ? *names.begin() : std::string();
}

/// A number that is the same for the same points in any order.
std::size_t key_of(const Contour& contour) {
  std::size_t key = 0;
  for (const Vec3& point : contour.points) {
    std::size_t own = 0;
    for (const double mm : point) own = own * 1'000'003 + std::hash<double>()(mm);
    key += own;
  }
  return key;
}

/// Adds one contour. Errors: its points are missing, no numbers, or fewer or more than it says.
Result<void> add_contour(const DicomItem& item, ContourRoi& roi, OddContours& odd) {
  const std::string kind = text_of(item, rt::kind);
  const auto numbers = numbers_of(item, rt::points);
  const auto count = whole_number(item, rt::count);
  if (numbers.empty() || numbers.size() % 3 != 0)
    return fail("", "has a contour whose points are missing or no numbers");
  if (count && static_cast<std::size_t>(std::max(*count, 0)) != numbers.size() / 3)
    return fail("", "has a contour of " + std::to_string(numbers.size() / 3) + " points that says it has " +
                        std::to_string(*count));
  Contour contour;
  for (std::size_t p = 0; p < numbers.size(); p += 3) {
    const Vec3 point(numbers[p], numbers[p + 1], numbers[p + 2]);
    // Points that are there twice add no edge.
    if (contour.points.empty() || point != contour.points.back()) contour.points.push_back(point);
  }
  const auto offset = numbers_of(item, rt::offset);
  odd.moved += std::ranges::any_of(offset, [](double mm) { return mm != 0; }) ? 1 : 0;
  if (kind == "POINT") {
    roi.points.insert(roi.points.end(), contour.points.begin(), contour.points.end());
    return {};
  }
  contour.image = image_of(item);
  contour.closed = !kind.starts_with("OPEN");
  contour.cuts_out = kind == "CLOSEDPLANAR_XOR";
  constexpr std::array known_kinds{"CLOSED_PLANAR", "CLOSEDPLANAR_XOR", "OPEN_PLANAR", "OPEN_NONPLANAR"};
  if (std::ranges::find(known_kinds, kind) == known_kinds.end()) {
    odd.unknown_kind = kind;
    ++odd.of_unknown_kind;
  }
  if (contour.closed && contour.points.size() > 1 && contour.points.front() == contour.points.back())
    contour.points.pop_back();
  if (contour.closed && contour.points.size() < 3) {  // it has no inside
    ++odd.short_ones;
    roi.points.insert(roi.points.end(), contour.points.begin(), contour.points.end());
    return {};
  }
  const std::size_t key = key_of(contour);
  // Two that are combined by exclusive or cancel out, as they are meant to.
  if (!contour.cuts_out)
    for (std::size_t k = 0; k < roi.contours.size(); ++k)
      if (odd.keys[k] == key && is_same_line(roi.contours[k], contour)) {
        ++odd.doubled;
        return {};
      }
  odd.keys.push_back(key);
  roi.contours.push_back(std::move(contour));
  return {};
}

/// Adds what was drawn to the structures that are described.
Result<void> add_drawn(const DicomSet& set, std::vector<ContourRoi>& rois) {
  Result<void> result;
  std::map<int, OddContours> odd;
  for_each_item(set.elements, rt::drawn, [&](const DicomItem& item) {
    if (!result) return;
    const auto number = whole_number(item, rt::of_roi);
    const auto roi =
        std::find_if(rois.begin(), rois.end(), [&](const ContourRoi& one) { return number && one.number == *number; });
    if (roi == rois.end()) {
      result = fail(set.path.string(), "has contours of structure " + (number ? std::to_string(*number) : "?") +
                                           ", which it does not describe; export it again");
      return;
    }
    roi->colour = roi_colour(item);
    for_each_item(item, rt::contours, [&](const DicomItem& contour) {
      if (!result) return;
      if (auto added = add_contour(contour, *roi, odd[roi->number]); !added)
        result = fail(set.path.string(), "in its structure " + std::to_string(roi->number) + " (" + excerpt(roi->name) +
                                             ") " + added.error().what + "; export it again");
    });
  });
  for (ContourRoi& roi : rois) roi.doubts = odd[roi.number].doubts();
  return result;
}

std::string roi_words(const ContourRoi& roi) {
  return "structure " + std::to_string(roi.number) + " (" + excerpt(roi.name) + ")";
}

constexpr double same_direction = 1e-3;

/// The planes on which closed contours lie: of each the centre of the first, and the unit normal.
std::vector<std::pair<Vec3, Vec3>> planes_with(const std::vector<Contour>& contours) {
  constexpr double same_mm = 0.01;
  std::vector<std::pair<Vec3, Vec3>> known;
  for (const Contour& contour : contours) {
    if (!contour.closed) continue;
    const auto [centre, normal] = plane_of(contour);
    if (std::none_of(known.begin(), known.end(), [&, at = centre, across = normal](const auto& plane) {
          return across.cross(plane.second).norm() < same_direction &&
                 std::abs((at - plane.first).dot(plane.second)) < same_mm;
        }))
      known.emplace_back(centre, normal);
  }
  return known;
}

double cross2(double ax, double ay, double bx, double by) {
  return ax * by - ay * bx;
}

}  // namespace

std::size_t ContourRoi::all_points() const {
  std::size_t all = points.size();
  for (const Contour& contour : contours) all += contour.points.size();
  return all;
}

std::size_t ContourRoi::planes() const {
  return planes_with(contours).size();
}

std::optional<double> ContourRoi::planes_apart_mm() const {
  const auto planes = planes_with(contours);
  if (planes.size() < 2) return {};
  const Vec3& normal = planes.front().second;
  std::vector<double> heights, gaps;
  for (const auto& [centre, own] : planes) {
    if (normal.cross(own).norm() >= same_direction) return {};
    heights.push_back(centre.dot(normal));
  }
  std::sort(heights.begin(), heights.end());
  for (std::size_t k = 1; k < heights.size(); ++k) gaps.push_back(heights[k] - heights[k - 1]);
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>((gaps.size() - 1) / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return *middle;
}

bool is_same_line(const Contour& a, const Contour& b) {
  const std::size_t n = a.points.size();
  if (a.closed != b.closed || a.cuts_out != b.cuts_out || n != b.points.size()) return false;
  const auto runs = [&](std::size_t begin, bool forward) {
    for (std::size_t k = 0; k < n; ++k)
      if (a.points[k] != b.points[(begin + (forward ? k : n - k)) % n]) return false;
    return true;
  };
  if (n == 0) return true;
  if (!a.closed) return runs(0, true) || runs(n - 1, false);
  // No contour that somebody drew comes back to its first point more often.
  int returns = 64;
  for (std::size_t begin = 0; begin < n && returns > 0; ++begin)
    if (b.points[begin] == a.points[0]) {
      --returns;
      if (runs(begin, true) || runs(begin, false)) return true;
    }
  return false;
}

std::pair<Vec3, Vec3> plane_of(const Contour& contour) {
  const auto& p = contour.points;
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero(), widest = Vec3::Zero();
  for (const Vec3& point : p) centre += point / static_cast<double>(p.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec3 corner = (p[k] - centre).cross(p[(k + 1) % p.size()] - centre);
    normal += corner;
    if (corner.squaredNorm() > widest.squaredNorm()) widest = corner;
  }
  // Lobes of a contour that crosses itself may cancel out; then the widest corner tells the plane.
  constexpr double cancelled = 1e-3;
  if (normal.norm() < cancelled * widest.norm()) normal = widest;
  return {centre, normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3(Vec3::Zero())};
}

bool crosses_itself(const Contour& contour) {
  const auto& p = contour.points;
  if (!contour.closed || p.size() < 4) return false;
  // In the two coordinates in which the plane is seen largest.
  int across = 0;
  plane_of(contour).second.cwiseAbs().maxCoeff(&across);
  const int u = (across + 1) % 3, v = (across + 2) % 3;
  const auto side = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return cross2(b[u] - a[u], b[v] - a[v], c[u] - a[u], c[v] - a[v]);
  };
  // Edges by where they begin along u, so that only those are compared that meet there.
  struct Edge {
    double from, to;
    std::size_t begin;
  };
  const std::size_t n = p.size();
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < n; ++k)
    edges.push_back({std::min(p[k][u], p[(k + 1) % n][u]), std::max(p[k][u], p[(k + 1) % n][u]), k});
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return std::pair(a.from, a.begin) < std::pair(b.from, b.begin); });
  // No contour that somebody drew needs more; of others nothing is said.
  constexpr std::size_t most_comparisons = 50'000'000;
  std::size_t compared = 0;
  for (std::size_t e = 0; e < n; ++e)
    for (std::size_t o = e + 1; o < n && edges[o].from < edges[e].to && ++compared < most_comparisons; ++o) {
      const Vec3 &a = p[edges[e].begin], &b = p[(edges[e].begin + 1) % n];
      const Vec3 &c = p[edges[o].begin], &d = p[(edges[o].begin + 1) % n];
      if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return true;
    }
  return false;
}

bool holds_contours(const fs::path& path) {
  if (!looks_like_dicom(path)) return false;
  const auto set = parse_dicom(path);
  return set && is_structure_set(*set);
}

Result<Contours> read_contours(const fs::path& path) {
  const auto set = parse_dicom(path);
  if (!set) return fail(set.error());
  if (!is_structure_set(*set))
    return fail(path.string(), "holds no contours (a DICOM structure set, RTSTRUCT); name the file that does");
  std::vector<std::string> warnings;
  auto rois = described_rois(*set, warnings);
  if (!rois) return fail(rois.error());
  const auto spaces = spaces_of(set->elements);
  if (spaces.empty())
    return fail(path.string(),
                "names no frame of reference, so that the place of its contours in the patient is not "
                "known; export it again from the series that it was drawn on");
  if (spaces.size() > 1)
    return fail(path.string(), "gives its structures in " + std::to_string(spaces.size()) +
                                   " frames of reference; export those of each scan by themselves");
  if (auto added = add_drawn(*set, *rois); !added) return fail(added.error());
  Contours contours{.rois = std::move(*rois),
                    .frame_of_reference = *spaces.begin(),
                    .referenced = drawn_images(set->elements),
                    .warnings = std::move(warnings)};
  for (std::string& doubt : doubts_about(path, contours.rois)) contours.warnings.push_back(std::move(doubt));
  return contours;
}

std::vector<std::string> doubts_about(const fs::path& path, const std::vector<ContourRoi>& rois) {
  std::vector<std::string> warnings;
  for (const ContourRoi& roi : rois) {
    if (roi.all_points() == 0)
      warnings.push_back(path.string() + ": has no points in its " + roi_words(roi) +
                         "; draw it, or leave it out of the export");
    for (const std::string& doubt : roi.doubts)
      warnings.push_back(path.string() + ": has in its " + roi_words(roi) + " " + doubt);
    const auto crossing = std::count_if(roi.contours.begin(), roi.contours.end(), crosses_itself);
    if (crossing > 0)
      warnings.push_back(
          path.string() + ": has " + std::to_string(crossing) + " of " + std::to_string(roi.contours.size()) +
          " contours of its " + roi_words(roi) +
          " that cross themselves, so that their inside is doubtful; correct them where they were drawn");
  }
  return warnings;
}

Result<const ContourRoi*> roi_of(const Contours& contours, const std::string& asked) {
  // A number may be 0 here, which no label is.
  if (const auto number = as_number<int>(trimmed(asked)))
    for (const ContourRoi& roi : contours.rois)
      if (roi.number == *number) return &roi;
  Segmentation known;
  for (const ContourRoi& roi : contours.rois) known.add({.name = roi.name, .value = roi.number});
  const auto segments = asked_segments(asked, known);
  const bool named = std::ranges::any_of(contours.rois, [&](const ContourRoi& roi) {
    return name_likeness(std::string(trimmed(asked)), roi.name) != NameLikeness::none;
  });
  if (!segments && named) return fail(segments.error());
  if (segments && segments->size() != 1)
    return fail("", "holds several structures of \"" + excerpt(asked) + "\"; name one");
  for (const ContourRoi& roi : contours.rois)
    if (segments && roi.number == segments->front().value) return &roi;
  std::vector<std::string> names;
  for (const ContourRoi& roi : contours.rois)
    names.push_back(std::to_string(roi.number) + " (" + excerpt(roi.name) + ")");
  return fail("", "has no structure \"" + excerpt(asked) + "\"; it has " + listed(names, " and "));
}

}  // namespace homolog
