#include "app/editor/work/demo.h"

#include <algorithm>

#include "core/catalogue/catalogue.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

Result<Document> demo_document(Organ organ, int subject) {
  auto the_template = load_template(built_in_source(organ));
  if (!the_template) return fail(the_template.error());
  PhantomSubject phantom = make_phantom(organ, subject);
  auto volume = std::make_shared<const Volume>(std::move(phantom.image));
  Document document = new_document(phantom_source(organ, subject), volume, *the_template);

  const auto& landmarks = (*the_template)->landmarks;
  std::vector<std::pair<Vec3, Vec3>> pairs;
  for (const Landmark& from : landmarks) {
    const auto to = std::find_if(phantom.landmarks.begin(), phantom.landmarks.end(),
                                 [&](const Landmark& l) { return l.name == from.name; });
    if (to != phantom.landmarks.end()) pairs.emplace_back(from.position, to->position);
  }
  Points from(pairs.size(), 3), to(pairs.size(), 3);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    from.row(static_cast<Eigen::Index>(i)) = pairs[i].first;
    to.row(static_cast<Eigen::Index>(i)) = pairs[i].second;
  }
  Shape& shape = document.shapes.at(0);
  shape.placement = shape.before_landmarks = nearest_similarity(from, to, shape.placement);
  shape.placed = std::make_shared<const Points>(shape.placement.apply((*the_template)->points));
  shape.reference = shape.points = shape.placed;
  return document;
}

Result<FirstCase> first_case() {
  auto demo = demo_document(Organ::kidney, 1);
  if (!demo) return fail(demo.error());
  FirstCase first{std::move(*demo), {}};
  Shape& shape = first.document.shapes.at(0);
  // Smaller, turned and aside, as a template lies that was only put near the organ.
  const Vec3 centre = bounds_of(*shape.placed).center();
  Similarity off;
  off.scale = 0.82;
  off.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.14, Vec3::UnitY()));
  off.translation = centre - off.scale * (off.rotation * centre) + Vec3(1, 1, -2);
  shape.placement = shape.before_landmarks = off.after(shape.placement);
  shape.placed = std::make_shared<const Points>(shape.placement.apply(first.document.the_template->points));
  shape.reference = shape.points = shape.placed;
  first.guide = guide_to(first.document.mesh(), phantom_truth(Organ::kidney, 1).front().points);
  return first;
}

}  // namespace homolog
