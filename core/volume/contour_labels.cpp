#include "core/volume/contour_labels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include "core/base/processes/memory.h"
#include "core/base/text/text.h"
#include "core/volume/dicom/dicom_stack.h"
#include "core/volume/dicom/resample_slices.h"
#include "core/volume/referenced_images.h"
#include "core/volume/stored_voxels.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// How far the points of a contour may lie off the slice, in slices: what decimals and rounded places leave.
constexpr double off_slice = 0.1;
/// How far a voxel's centre may lie off a contour that goes through it, in voxels.
constexpr double on_path = 1e-3;

using Polygon = std::vector<Vec3>;  ///< in voxels

/// The contours of a structure on the slices across one axis of the grid.
struct SlicedRoi {
  int axis = 2;
  std::map<int, std::vector<std::pair<Polygon, bool>>> slices;  ///< with whether it is combined by exclusive or
  std::size_t closed = 0, off_slices = 0;                       ///< how many there are, and lie on no slice
  std::size_t elsewhere = 0;            ///< how many refer to the image of another slice than the one that they lie on
  std::pair<int, int> first_elsewhere;  ///< both numbers of the first of them
};

std::string about_roi(const ContourRoi& roi) {
  return "structure " + std::to_string(roi.number) + " (" + excerpt(roi.name) + ")";
}

/// How far a polygon reaches across slices.
std::pair<double, double> reach_across(const Polygon& polygon, int axis) {
  const auto [low, high] =
      std::ranges::minmax_element(polygon, [axis](const Vec3& a, const Vec3& b) { return a[axis] < b[axis]; });
  return {(*low)[axis], (*high)[axis]};
}

/// The slice across an axis on which a polygon lies. Nothing where there is none.
std::optional<int> slice_of(const Polygon& polygon, int axis) {
  const auto [low, high] = reach_across(polygon, axis);
  const double slice = std::rint(0.5 * (low + high));
  if (!(std::abs(slice) < 1e9) || low < slice - off_slice || high > slice + off_slice) return {};
  return static_cast<int>(slice);
}

/// The old slices that a grid was resampled from, and those of its slices that are nearest to each.
class ResampledPlanes {
 public:
  ResampledPlanes(const ResampledSlices& done) : slices_(done.slices), nearest_(done.slices.size()) {
    for (int k = 0; k < done.dims[2]; ++k) {
      const TakenSlice taken = taken_by(slices_, k);
      const OldSlice& old = slices_[taken.old];
      nearest_[taken.old].push_back({k, Vec3(taken.column - old.column, taken.row - old.row, 0)});
    }
  }

  /// Puts a polygon on the slices that take over the old one on which it lies. Gives that one; nothing where there is
  /// none.
  std::optional<int> add(const Polygon& polygon, bool cuts_out, SlicedRoi& roi) const {
    const auto reach = reach_across(polygon, 2);
    const auto on = std::ranges::find_if(slices_, [&](const OldSlice& old) {
      return reach.first >= old.height - off_slice && reach.second <= old.height + off_slice;
    });
    if (on == slices_.end()) return {};
    for (const auto& [k, way] : nearest_[on - slices_.begin()]) {
      Polygon moved = polygon;
      for (Vec3& point : moved) point += way;
      roi.slices[k].emplace_back(std::move(moved), cuts_out);
    }
    return static_cast<int>(on - slices_.begin());
  }

 private:
  struct Taken {
    int slice = 0;
    Vec3 way = Vec3::Zero();  ///< in voxels, from the old slice to this one
  };
  std::vector<OldSlice> slices_;
  std::vector<std::vector<Taken>> nearest_;
};

/// The contours of a structure on the slices across the axis where most of them lie on some. `resampled`: null where
/// the grid is that of the series. `images`: the image's, by their names.
SlicedRoi sliced(const ContourRoi& roi, const VolumeGeometry& grid, const ResampledPlanes* resampled,
                 const std::map<std::string, const SourceImage*>& images) {
  struct Drawn {
    Polygon polygon;
    bool cuts_out = false;
    std::string image;
  };
  std::vector<Drawn> polygons;
  const Mat3 back = grid.direction.inverse();
  for (const Contour& contour : roi.contours) {
    if (!contour.closed) continue;
    Polygon polygon;
    for (const Vec3& point : contour.points)
      polygon.push_back((back * (point - grid.origin_mm)).cwiseQuotient(grid.spacing_mm));
    polygons.push_back({std::move(polygon), contour.cuts_out, contour.image});
  }
  SlicedRoi result;
  result.closed = polygons.size();
  std::ptrdiff_t most = 0;
  for (const int axis : {2, 1, 0}) {
    if (resampled != nullptr) break;
    const auto on =
        std::ranges::count_if(polygons, [&](const Drawn& one) { return slice_of(one.polygon, axis).has_value(); });
    if (on > most) result.axis = axis;
    most = std::max(most, on);
  }
  for (auto& [polygon, cuts_out, uid] : polygons) {
    const auto slice =
        resampled != nullptr ? resampled->add(polygon, cuts_out, result) : slice_of(polygon, result.axis);
    if (!slice) {
      ++result.off_slices;
      continue;
    }
    if (resampled == nullptr) result.slices[*slice].emplace_back(std::move(polygon), cuts_out);
    const auto image = result.axis == 2 ? images.find(uid) : images.end();
    if (image == images.end() || image->second == nullptr || image->second->slice == *slice) continue;
    if (result.elsewhere++ == 0) result.first_elsewhere = {*slice, image->second->slice};
  }
  return result;
}

/// Words that contours lie on no slices: a sentence without its file.
std::string off_slices_words(const ContourRoi& roi, const SlicedRoi& sliced, const fs::path& image_path) {
  const std::string some = sliced.off_slices == sliced.closed ? "its "
                                                              : std::to_string(sliced.off_slices) + " of " +
                                                                    std::to_string(sliced.closed) + " contours of its ";
  return "draws " + some + about_roi(roi) + " on planes that are no slices of " + image_path.string() +
         "; give the series that it was drawn on by --like, and not resampled";
}

/// That contours leave most slices between them out: a sentence without its file; empty: they do not, or there are too
/// few to tell.
std::string striped_words(const ContourRoi& roi, const SlicedRoi& sliced, const VolumeGeometry& grid) {
  constexpr std::size_t fewest = 3;
  std::vector<int> gaps;
  for (auto slice = sliced.slices.begin(); slice != sliced.slices.end(); ++slice)
    if (const auto next = std::next(slice); next != sliced.slices.end()) gaps.push_back(next->first - slice->first);
  if (gaps.size() + 1 < fewest) return {};
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>((gaps.size() - 1) / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  if (*middle < 2) return {};
  const double slice_mm = grid.spacing_mm[sliced.axis];
  return "its " + about_roi(roi) + " is drawn on " + std::to_string(sliced.slices.size()) + " planes, mostly " +
         mm_text(*middle * slice_mm) + " apart, and the slices lie " + mm_text(slice_mm) +
         " apart, so that those between its planes stay empty; draw it on all of them, or fit a mesh to its contours "
         "(homolog fit TEMPLATE --contours FILE)";
}

/// That contours refer to images of other slices than their own: a sentence without its file.
std::string elsewhere_words(const ContourRoi& roi, const SlicedRoi& sliced) {
  const bool one = sliced.elsewhere == 1;
  const auto [lies, refers] = sliced.first_elsewhere;
  return "its " + about_roi(roi) + " has " + std::to_string(sliced.elsewhere) +
         (one ? " contour that refers to the image of another slice than the one it lies on"
              : " contours that refer to the image of another slice than the one they lie on") +
         " (" + (one ? "it" : "the first") + " lies on slice " + std::to_string(lies + 1) +
         " of its series and refers to the image of slice " + std::to_string(refers + 1) + "); " +
         (one ? "its place was taken" : "their places were taken");
}

/// The places at which a line of voxel centres crosses the edges of a polygon, ascending. An edge holds its lower end
/// alone, so that a line through a corner crosses one of two edges.
std::vector<double> crossings(const Polygon& polygon, int along, int across, double line) {
  std::vector<double> places;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((a[across] <= line) == (b[across] <= line)) continue;
    // From the lower end, so that an edge that is passed both ways is crossed at one place.
    const Vec3 &low = a[across] < b[across] ? a : b, &high = a[across] < b[across] ? b : a;
    places.push_back(low[along] + (line - low[across]) / (high[across] - low[across]) * (high[along] - low[along]));
  }
  std::sort(places.begin(), places.end());
  return places;
}

/// Calls `see(p, line)` for the voxel centres of a slice that lie on an edge of a polygon.
template <class See>
void for_each_on_path(const Polygon& polygon, int along, int across, int columns, int lines, const See& see) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double da = b[along] - a[along], dc = b[across] - a[across], length = std::hypot(da, dc);
    const auto range = [](double u, double v, int count) {
      return std::pair(static_cast<int>(std::clamp(std::ceil(std::min(u, v) - on_path), 0.0, count + 0.0)),
                       static_cast<int>(std::clamp(std::floor(std::max(u, v) + on_path), -1.0, count - 1.0)));
    };
    const auto [first_line, last_line] = range(a[across], b[across], lines);
    for (int line = first_line; line <= last_line; ++line) {
      // Of a steep edge only a short piece lies near the line.
      double from = a[along], to = b[along];
      if (std::abs(dc) > on_path) {
        const double at = a[along] + (line - a[across]) / dc * da, reach = on_path * length / std::abs(dc);
        from = std::max(std::min(a[along], b[along]), at - reach);
        to = std::min(std::max(a[along], b[along]), at + reach);
        if (from > to) from = to = std::clamp(at, std::min(a[along], b[along]), std::max(a[along], b[along]));
      }
      const auto [first, last] = range(from, to, columns);
      for (int p = first; p <= last; ++p) {
        const double share =
            length > 0 ? std::clamp(((p - a[along]) * da + (line - a[across]) * dc) / (length * length), 0.0, 1.0) : 0;
        if (std::hypot(a[along] + share * da - p, a[across] + share * dc - line) <= on_path) see(p, line);
      }
    }
  }
}

/// A mask of one structure, and what is to be said of it.
struct DrawnMask {
  std::vector<std::uint8_t> inside;
  bool any = false, leaves_image = false;
  std::size_t nested_slices = 0;  ///< slices in which contours lie within one another without being said to be holes
};

/// Adds the polygons of one slice.
void draw_slice(const VolumeGeometry& grid, int axis, int slice, const std::vector<std::pair<Polygon, bool>>& polygons,
                DrawnMask& mask) {
  const int along = axis == 0 ? 1 : 0, across = axis == 2 ? 1 : 2;
  const std::array<std::size_t, 3> stride{
      1, static_cast<std::size_t>(grid.dims[0]),
      static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1])};
  const auto dims = [&](int a) { return grid.dims[a]; };
  const auto step = [&](int a) { return stride[a]; };
  bool nested = false;
  std::vector<std::uint8_t> times(static_cast<std::size_t>(dims(along)));
  for (int line = 0; line < dims(across); ++line) {
    std::fill(times.begin(), times.end(), std::uint8_t{0});
    bool touched = false;
    for (const auto& [polygon, cuts_out] : polygons) {
      const auto places = crossings(polygon, along, across, line);
      for (std::size_t c = 0; c + 1 < places.size(); c += 2) {
        const double from = std::clamp(std::ceil(places[c]), 0.0, static_cast<double>(dims(along)));
        const double to = std::clamp(std::ceil(places[c + 1]), 0.0, static_cast<double>(dims(along)));
        for (auto p = static_cast<std::size_t>(from); p < static_cast<std::size_t>(to); ++p) {
          nested = nested || (!cuts_out && times[p] % 2 != 0);
          ++times[p];
          touched = true;
        }
      }
    }
    if (!touched) continue;
    const std::size_t begin =
        static_cast<std::size_t>(slice) * step(axis) + static_cast<std::size_t>(line) * step(across);
    for (std::size_t p = 0; p < times.size(); ++p) {
      mask.inside[begin + p * step(along)] = times[p] % 2;
      mask.any = mask.any || times[p] % 2 != 0;
    }
  }
  mask.nested_slices += nested ? 1 : 0;
  // Points along the path of a contour are part of the structure [DICOM PS3.3, C.8.8.6.3], those around a hole too.
  for (const auto& [polygon, cuts_out] : polygons)
    for_each_on_path(polygon, along, across, dims(along), dims(across), [&](int p, int line) {
      mask.inside[static_cast<std::size_t>(slice) * step(axis) + static_cast<std::size_t>(line) * step(across) +
                  static_cast<std::size_t>(p) * step(along)] = 1;
      mask.any = true;
    });
}

DrawnMask drawn_mask(const VolumeGeometry& grid, const SlicedRoi& roi) {
  DrawnMask mask;
  mask.inside.resize(grid.voxels());
  for (const auto& [slice, polygons] : roi.slices) {
    for (const auto& [polygon, cuts_out] : polygons)
      for (const Vec3& point : polygon)
        for (int a = 0; a < 3; ++a)
          if (const double last = grid.dims[a] - 1; point[a] < -0.5 || point[a] > last + 0.5) mask.leaves_image = true;
    if (slice >= 0 && slice < grid.dims[roi.axis]) draw_slice(grid, roi.axis, slice, polygons, mask);
  }
  return mask;
}

void warn_of(const fs::path& path, const ContourRoi& roi, const DrawnMask& mask, const fs::path& image_path,
             std::vector<std::string>& warnings) {
  const std::string of = path.string() + ": its " + about_roi(roi);
  if (mask.leaves_image)
    warnings.push_back(of + " reaches beyond " + image_path.string() +
                       ", where it has no voxels; give an image that "
                       "holds it");
  if (mask.nested_slices > 0)
    warnings.push_back(of + " has contours within one another on " + std::to_string(mask.nested_slices) +
                       (mask.nested_slices == 1 ? " plane" : " planes") +
                       " that are not said to be holes; what two of them hold was left out");
  if (!mask.any) warnings.push_back(of + " holds the centre of no voxel, so that it has none");
}

/// The labels of all structures, each in the first layer in which it overlaps none.
using Layers = std::vector<std::vector<std::uint16_t>>;

std::size_t put_in_layers(const std::vector<std::uint8_t>& inside, int number, Layers& layers) {
  std::size_t layer = 0;
  const auto overlaps = [&](const std::vector<std::uint16_t>& labels) {
    for (std::size_t v = 0; v < inside.size(); ++v)
      if (inside[v] != 0 && labels[v] != 0) return true;
    return false;
  };
  while (layer < layers.size() && overlaps(layers[layer])) ++layer;
  if (layer == layers.size()) layers.emplace_back(inside.size());
  for (std::size_t v = 0; v < inside.size(); ++v)
    if (inside[v] != 0) layers[layer][v] = static_cast<std::uint16_t>(number);
  return layer;
}

}  // namespace

Result<VolumeRead> labels_of_contours(const fs::path& path, const Contours& contours, const fs::path& image_path,
                                      const Volume& image, Progress* progress,
                                      const std::optional<ResampledSlices>& resampled) {
  auto other = check_scan(path, contours.frame_of_reference, contours.referenced, image_path, image, " by --like");
  if (!other) return fail(other.error());
  const VolumeGeometry& grid = image.geometry;
  if (auto enough = check_memory(path, 4 * static_cast<double>(grid.voxels())); !enough) return fail(enough.error());
  VolumeRead result;
  result.warnings = contours.warnings;
  if (*other) result.warnings.push_back(std::move(**other));
  const bool are_labels = std::all_of(contours.rois.begin(), contours.rois.end(), [](const ContourRoi& roi) {
    return roi.number >= 1 && roi.number <= std::numeric_limits<std::uint16_t>::max();
  });
  if (!are_labels)
    result.warnings.push_back(path.string() +
                              ": numbers a structure beyond what a label can be (1 to 65535), so that labels count its "
                              "structures from 1");
  const auto named_images = images_by_name(image.images);
  std::optional<ResampledPlanes> planes;
  if (resampled) planes.emplace(*resampled);
  if (resampled) result.warnings.push_back(taken_sentence(path, "contours", *resampled, grid));
  Layers layers;
  std::optional<Error> off_slices;
  for (std::size_t r = 0; r < contours.rois.size(); ++r) {
    const ContourRoi& roi = contours.rois[r];
    if (progress && progress->cancelled()) return fail(path.string(), "was not read: cancelled");
    if (progress) progress->report(static_cast<double>(r) / static_cast<double>(contours.rois.size()));
    const SlicedRoi on_slices = sliced(roi, grid, planes ? &*planes : nullptr, named_images);
    if (on_slices.elsewhere > 0) result.warnings.push_back(path.string() + ": " + elsewhere_words(roi, on_slices));
    if (const std::string striped = planes ? std::string() : striped_words(roi, on_slices, grid); !striped.empty())
      result.warnings.push_back(path.string() + ": " + striped);
    if (on_slices.off_slices > 0) {  // the others go on
      const std::string words = off_slices_words(roi, on_slices, image_path);
      result.warnings.push_back(path.string() + ": " + words + " (left out)");
      if (!off_slices && on_slices.slices.empty()) off_slices = Error{path.string(), words};
      if (on_slices.slices.empty()) continue;
    }
    if (on_slices.slices.empty()) {
      if (roi.all_points() > 0)
        result.warnings.push_back(path.string() + ": its " + about_roi(roi) +
                                  " has points or lines alone, which hold no voxels");
      continue;
    }
    const DrawnMask mask = drawn_mask(grid, on_slices);
    warn_of(path, roi, mask, image_path, result.warnings);
    const int label = are_labels ? roi.number : static_cast<int>(r) + 1;
    result.segmentation.add(
        {.name = roi.name, .value = label, .layer = put_in_layers(mask.inside, label, layers), .colour = roi.colour});
  }
  if (layers.empty() && off_slices) return fail(std::move(*off_slices));
  if (layers.empty())
    return fail(path.string(),
                "has no closed contours, so that no label map can be made of it; `info` lists what it has");
  for (std::size_t l = 0; l < layers.size(); ++l) {
    Volume layer;
    layer.geometry = grid;
    layer.frame_of_reference = contours.frame_of_reference;
    if (auto kept = keep_voxels(std::move(layers[l]), {}, path.string(), layer, result.warnings); !kept)
      return fail(kept.error());
    (l == 0 ? result.volume : result.other_layers.emplace_back()) = std::move(layer);
  }
  return result;
}

}  // namespace homolog
