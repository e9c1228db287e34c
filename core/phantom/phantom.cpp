#include "core/phantom/phantom.h"

#include <cassert>

#include "core/phantom/organs.h"

namespace homolog {

PhantomSubject make_phantom(Organ organ, int number, double spacing_mm, const Progress* progress) {
  switch (organ) {
    case Organ::kidney:
      return phantom::kidney_subject(number, spacing_mm, progress);
    case Organ::vertebra:
      return phantom::vertebra_subject(number, spacing_mm, progress);
    case Organ::ventricle:
      return phantom::ventricle_subject(number, spacing_mm, progress);
  }
  assert(false);
  return {};
}

std::vector<MeshFile> phantom_truth(Organ organ, int number) {
  switch (organ) {
    case Organ::kidney:
      return phantom::kidney_truth(number);
    case Organ::vertebra:
      return phantom::vertebra_truth(number);
    case Organ::ventricle:
      return phantom::ventricle_truth(number);
  }
  assert(false);
  return {};
}

MeshFile built_in_template(Organ organ) {
  switch (organ) {
    case Organ::kidney:
      return phantom::kidney_template();
    case Organ::vertebra:
      return phantom::vertebra_template();
    case Organ::ventricle:
      return phantom::ventricle_template();
  }
  assert(false);
  return {};
}

Result<Organ> organ_from_name(const std::string& name) {
  for (const Organ organ : {Organ::kidney, Organ::vertebra, Organ::ventricle})
    if (name == organ_name(organ)) return organ;
  return fail(name, "is no organ of the phantoms; choose kidney, vertebra, ventricle or spine");
}

const char* organ_name(Organ organ) {
  switch (organ) {
    case Organ::kidney:
      return "kidney";
    case Organ::vertebra:
      return "vertebra";
    case Organ::ventricle:
      return "ventricle";
  }
  assert(false);
  return "";
}

}  // namespace homolog
