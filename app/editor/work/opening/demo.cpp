#include "app/editor/work/opening/demo.h"

#include <map>
#include <string>

#include "core/case/placing.h"
#include "core/catalogue/catalogue.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

Result<Document> demo_document(Organ organ, int subject) {
  auto the_template = load_template(built_in_source(organ));
  if (!the_template) return fail(the_template.error());
  PhantomSubject phantom = make_phantom(organ, subject);
  auto volume = std::make_shared<const Volume>(std::move(phantom.image));
  Document document = new_document(phantom_source(organ, subject), volume, *the_template);

  std::map<std::string, Vec3> landmarks;
  for (const Landmark& landmark : phantom.landmarks) landmarks[landmark.name] = landmark.position;
  const auto [from, to] = matched_landmarks(**the_template, landmarks);
  Shape& shape = document.shapes.at(0);
  shape.placement = shape.before_landmarks = nearest_similarity(from, to, shape.placement);
  start_anew(**the_template, shape);
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
  start_anew(*first.document.the_template, shape);
  first.guide = guide_to(first.document.mesh(), phantom_truth(Organ::kidney, 1).front().points);
  return first;
}

}  // namespace homolog
