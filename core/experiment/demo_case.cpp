#include "core/experiment/demo_case.h"

#include <map>
#include <string>

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
  const Similarity placement = nearest_similarity(from, to, document.view()->shape.placement);
  document.change({}, [&](Structure& structure) { structure = new_structure(structure.the_template, placement); });
  return document;
}

}  // namespace homolog
