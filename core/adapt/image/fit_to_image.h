#pragma once

#include <map>
#include <string>

#include "core/adapt/allowed_shapes.h"
#include "core/adapt/snap.h"
#include "core/template/template.h"

namespace homolog {

/// The placement of a template on those of its landmarks that were placed in an image, by name, LPS mm. Errors: fewer
/// than three of them, or places that contradict each other.
Result<Similarity> placement_by_landmarks(const Template& the_template, const std::map<std::string, Vec3>& landmarks);

/// Pins that hold a mesh at those of the template's landmarks that lie within `reach_mm` of where `points` (n×3) have
/// them.
std::vector<Pin> landmark_pins(const Template& the_template, const Points& points,
                               const std::map<std::string, Vec3>& landmarks, double reach_mm);

/// A template as it was drawn to the boundary that an image shows.
struct ImageFit {
  Mesh mesh;
  Points placed;  ///< n×3, LPS mm: where the snap began; with a model the allowed shape that is nearest to the image
  SnapResult snapped;
  std::size_t held_landmarks = 0;
};

/// Draws a template to the boundary that a frame of an image shows, from where `placement` puts it [snap.h].
/// `landmarks` within the reach of the snap are met exactly. With `allowed` the nearest shape that a model allows comes
/// first, and `beyond` (0…1) says how far the snap goes from there. Errors: those of snap().
Result<ImageFit> fit_to_image(const Template& the_template, const Volume& image, int frame, const Similarity& placement,
                              const std::map<std::string, Vec3>& landmarks, SnapOptions options,
                              const AllowedShapes* allowed = nullptr, double beyond = 1);

}  // namespace homolog
