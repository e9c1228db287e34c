#pragma once

#include <vector>

#include "core/phantom/deformation.h"
#include "core/phantom/phantom.h"

/// The functions that phantom.cpp asks of each organ.
namespace homolog::phantom {

MeshFile kidney_template();
MeshFile vertebra_template();
MeshFile ventricle_template();

std::vector<MeshFile> kidney_truth(int number);
std::vector<MeshFile> vertebra_truth(int number);
std::vector<MeshFile> ventricle_truth(int number);

PhantomSubject kidney_subject(int number, double spacing_mm, const Progress* progress);
PhantomSubject vertebra_subject(int number, double spacing_mm, const Progress* progress);
PhantomSubject ventricle_subject(int number, double spacing_mm, const Progress* progress);

}  // namespace homolog::phantom
