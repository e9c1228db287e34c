#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/topology.h"
#include "core/template/template.h"
#include "core/template_making/faced_part.h"
#include "core/volume/labels/segmentation.h"
#include "core/volume/volume.h"

namespace homolog {

/// A plane at which the scan ends and the organ goes on: outward · p = offset_mm.
struct ScanBorder {
  Vec3 outward = Vec3::UnitZ();
  double offset_mm = 0;
  /// Surface nearer to the plane than this is the cut and not the organ's own boundary: half a slice or more.
  double tolerance_mm = 0;
};

/// Which parts of a label are a target.
struct LabelParts {
  bool all = false;      ///< every part, else one alone
  std::size_t rank = 0;  ///< the number of that one by size: 0 is the largest
  /// The part of the surface that faces other labels, with as many `rims`; shorter ones are holes, and closed.
  std::optional<FacedLabels> faced{};
  std::size_t rims = 0;
};

/// A template of several closed pieces belongs to all parts, one of one piece to the largest.
LabelParts parts_for(const Topology& the_template);

/// The labels beyond the part of a label's surface that a template is of, in a map with such segments. Errors: the map
/// lacks one of them.
Result<FacedLabels> faced_labels(const FacedNames& names, const Segmentation& known);

/// The same, and the part of the surface that a template is of [Template::faced], in a map with such segments. If the
/// map lacks what that part faces, the whole surface is taken, with a warning.
LabelParts parts_for(const Template& the_template, const Segmentation& known, std::vector<std::string>& warnings);

/// The surface that a template is fitted to, LPS mm.
struct Boundary {
  Mesh surface;                          ///< outward oriented
  std::vector<ScanBorder> scan_borders;  ///< the borders of the scan that cut the organ off
  std::vector<std::string> warnings;     ///< each a sentence
  std::string why_whole;                 ///< why no part was taken of a label, but its whole surface: one of these
  std::size_t parts_left_out = 0;        ///< parts of a label that are no target
  double share_left_out = 0;             ///< their share of the label's volume
  std::size_t parts_alike = 1;           ///< a label's large parts: the largest, and those more than half as large
  /// One value a face: 1 where it is a cut through the organ and not its boundary [cut_faces.h]; empty: none is.
  std::vector<std::uint8_t> cut;

  /// Whether the scan shows what is at `p`. It does not beyond its borders, nor within their tolerance, where the flat
  /// face lies that the cut leaves.
  bool shows(const Vec3& p) const;
  /// Whether a face of the surface is the organ's own.
  bool is_own(std::int32_t face) const { return cut.empty() || cut[face] == 0; }
};

/// The boundary of a label: its largest part (or `parts`) with cavities filled, and with everything that a ball of
/// radius `closing_mm` (without: ball_share of the label's size) cannot reach from outside. Computed on isotropic
/// voxels of about a third of the mean edge of a mesh of `vertices` vertices. If the label faces none of the labels
/// that `parts` names, its whole boundary is taken, with a warning. Errors: the label does not occur; no such
/// frame; those of check_volume; fewer than four vertices; a closing radius that is negative or not finite.
Result<Boundary> label_boundary(const Volume& mask, int label, int frame, std::optional<double> closing_mm,
                                Eigen::Index vertices, const LabelParts& parts = {});

/// Whether a boundary is one that can be fitted to: also one that a program put together. Errors: no surface; those of
/// check_mesh; cuts of other faces; a border that is not finite.
Result<void> check_boundary(const Boundary& boundary);

/// A surface as a boundary: its largest part, or all of them. Throws std::invalid_argument for what check_mesh refuses.
Boundary mesh_boundary(const Mesh& mesh, bool all_parts = false);

/// The same for whatever surface a file holds: mended where it is broken [mesh_repair.h]. One that is riddled with
/// tunnels is rebuilt from voxels [solid_voxels.h], as fine as a mesh of `vertices` vertices shows, with a warning that
/// says how far that lies from it. `rims`: how many long rims the template has [long_rims]. If that is not 0, as
/// many of the surface's longest boundary loops are its rims, and loops shorter than two thirds of these are holes,
/// which are closed. So are those that make_mesh_template closes, where the rims are of those that it keeps. If it is
/// 0, holes are closed of a broken surface alone. Errors: no face is left; cancelled.
Result<Boundary> surface_boundary(const MeshFile& surface, Eigen::Index vertices, Progress* progress = nullptr,
                                  bool all_parts = false, std::size_t rims = 0);

}  // namespace homolog
