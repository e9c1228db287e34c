#include "app/editor/work/opening/demo.h"

#include "core/experiment/demo_case.h"

namespace homolog {

Result<FirstCase> first_case() {
  auto demo = demo_document(Organ::kidney, 1);
  if (!demo) return fail(demo.error());
  FirstCase first{std::move(*demo), {}};
  const Shape& shape = first.document.view()->shape;
  // Smaller, turned and aside, as a template lies that was only put near the organ.
  const Vec3 centre = bounds_of(*shape.placed).center();
  Similarity off;
  off.scale = 0.82;
  off.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.14, Vec3::UnitY()));
  off.translation = centre - off.scale * (off.rotation * centre) + Vec3(1, 1, -2);
  const Similarity beside = off.after(shape.placement);
  first.document.change({}, [&](Structure& structure) { structure = new_structure(structure.the_template, beside); });
  first.guide = guide_to(first.document.view()->mesh(), phantom_truth(Organ::kidney, 1).front().points);
  return first;
}

}  // namespace homolog
