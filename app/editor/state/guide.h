#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "app/editor/state/layout.h"
#include "core/case/document.h"

namespace homolog {

/// A pull of the first case: the outline goes to a place where the organ's boundary is known to be.
struct GuideStep {
  ViewKind view = ViewKind::coronal;
  Vec3 to_mm = Vec3::Zero();
  double far_mm = 0;  ///< how far the surface was from there at first
};

/// The guide that leads a newcomer through the first case, pull by pull.
struct Guide {
  std::vector<GuideStep> steps;
  std::size_t at = 0;  ///< the step to do; steps.size(): all are done
  bool shown = true;
};

/// Five pulls that bring a mesh near the true one: both ends, the outer side, front and back.
Guide guide_to(const Mesh& mesh, const Points& truth);

/// The place of the mesh that is to be pulled.
Vec3 pulled_from(const GuideStep& step, const Mesh& mesh);
/// Whether a step is done: most of the way to the boundary is gone.
bool is_done(const GuideStep& step, const Mesh& mesh);

}  // namespace homolog
