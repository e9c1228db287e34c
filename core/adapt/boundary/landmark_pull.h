#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/adapt/target.h"
#include "core/template/template.h"

namespace homolog {

/// A landmark that is trusted less than this is called a blunder, and not counted.
constexpr double believable = 0.5;

/// Adds the pull of the organ's landmarks to that of its boundary. A landmark pulls on the corners of the triangle it
/// lies in, by its weights there. `landmarks`: the organ's by name, LPS mm. `trust`: of those that the template
/// has too, in its order, 0 to 1.
void pull_landmarks(const Template& the_template, const std::map<std::string, Vec3>& landmarks,
                    const VertexScalars& trust, const Mesh& mesh, TargetPull& pull);

/// The names of those that are counted.
std::vector<std::string> believed_landmarks(const Template& the_template, const std::map<std::string, Vec3>& landmarks,
                                            const VertexScalars& trust);

/// Warnings about landmarks: those too few to place by, and those not believed. `off_mm`: how far each lies from
/// where the placement has it, as `trust`.
std::vector<std::string> warnings_of_landmarks(const Template& the_template,
                                               const std::map<std::string, Vec3>& landmarks, const VertexScalars& trust,
                                               const VertexScalars& off_mm);

}  // namespace homolog
