#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/topology.h"

namespace homolog {

// How large shapes are: the table that a paper begins with.

/// The size of one shape, and where its landmarks lie.
struct ShapeSizes {
  std::optional<double> volume_ml;         ///< enclosed; none for points alone and for an open surface
  std::optional<double> volume_capped_ml;  ///< an open surface's volume with its rims capped flat
  std::optional<double> area_mm2;          ///< the surface's area; none for points alone
  std::string inward;                      ///< why the volume is negative [inside_out.h]; empty: it is not
  std::vector<Landmark> landmarks;         ///< LPS mm
  double centroid_size_mm = 0;             ///< root of the sum of squared distances of the vertices from their mean
};

/// `faces`: of the shape before, used again where this one has the same; becomes those of this one. Errors: faces that
/// are no surface.
Result<ShapeSizes> sizes_of(const MeshFile& mesh, std::shared_ptr<const Topology>& faces);

using LandmarkPair = std::pair<std::string, std::string>;
/// Every two landmarks that at least one of the shapes has both of, in the order in which the shapes name them.
std::vector<LandmarkPair> landmark_pairs(const std::vector<ShapeSizes>& shapes);
/// The straight distance between two landmarks of a shape, mm; none where it lacks one.
std::optional<double> distance_mm(const ShapeSizes& sizes, const LandmarkPair& pair);

/// Mean and standard deviation (with 1/(n − 1)) of what is there of some values.
struct Spread {
  std::size_t count = 0;
  double mean = 0, sd = 0;  ///< sd: 0 of a single value
};
Spread spread_of(const std::vector<std::optional<double>>& values);

/// CSV: a row a shape with its name, volume_ml, volume_capped_ml where a shape is open, area_mm2, the distance of every
/// pair, centroid_size_mm and, where `groups` has one for each, its group; what is not known stays empty.
std::string sizes_table(const std::vector<std::string>& names, const std::vector<ShapeSizes>& shapes,
                        const std::vector<std::string>& groups = {});

}  // namespace homolog
