#include "app/editor/work/opening/demo.h"

#include <map>
#include <string>

#include "core/case/placing.h"
#include "core/catalogue/catalogue.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

/// Begins the mesh anew at a placement.
void place(Document& document, const Similarity& placement) {
  document.change({}, [&](Structure& structure) { structure = new_structure(structure.the_template, placement); });
}

}  // namespace

Result<Document> demo_document(Organ organ, int subject) {
  auto the_template = load_template(built_in_source(organ));
  if (!the_template) return fail(the_template.error());
  PhantomSubject phantom = make_phantom(organ, subject);
  auto volume = std::make_shared<const Volume>(std::move(phantom.image));
  Document document = new_document(phantom_source(organ, subject), volume, *the_template);

  std::map<std::string, Vec3> landmarks;
  for (const Landmark& landmark : phantom.landmarks) landmarks[landmark.name] = landmark.position;
  const auto [from, to] = matched_landmarks(**the_template, landmarks);
  place(document, nearest_similarity(from, to, document.view()->shape.placement));
  return document;
}

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
  place(first.document, off.after(shape.placement));
  first.guide = guide_to(first.document.view()->mesh(), phantom_truth(Organ::kidney, 1).front().points);
  return first;
}

}  // namespace homolog
