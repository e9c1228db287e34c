#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

// How two inputs meet: whether one of them has its lengths in another unit than mm, or its coordinates in RAS. What
// is found is said and offered, never done. A small organ is no wrong unit: sizes alone count only where no two organs
// of one kind differ so much, as of a man and of a mouse.

/// The movement that brings the first of two things to the second: it is scaled about the origin of its coordinates,
/// and turned.
struct Misfit {
  double factor = 1;       ///< 1 where the sizes agree; else mostly 10, 100, 1,000, 1,000,000 or one over these
  bool half_turn = false;  ///< x and y negated: LPS for RAS
};

/// A mesh and a surface of the same organ in the same scan, where they lie far apart: what makes them agree; else what
/// their sizes say.
std::optional<Misfit> misfit_in_scan(const Mesh& mesh, const Mesh& other);

/// Things of one kind from anywhere, by their sizes in mm. None unless one is 50 times as large as the other.
std::optional<Misfit> misfit_of_size(double size_mm, double other_mm);

/// A mesh or label within `box` and the image that it should lie in: one that is smaller than two voxels, far larger
/// than the image, or beside it and would lie in it. `image`: its grid.
std::optional<Misfit> misfit_in_image(const Box& box, const VolumeGeometry& image);

/// One of two things that meet: its file's name and its size in mm.
struct Meeting {
  std::string name;
  double size_mm = 0;
};
/// "a.ply: is 1,000 times smaller than b.nii.gz; are its lengths in metres? …", with the remedy. The one of the two is
/// blamed whose size no organ has, else the first.
std::string misfit_sentence(const Misfit& misfit, const Meeting& mesh, const Meeting& other);

/// The same of many things of one kind, each against the usual size of all. `kind`: "the other shapes".
std::vector<std::string> misfits_among(const std::vector<Meeting>& all, const std::string& kind);

}  // namespace homolog
