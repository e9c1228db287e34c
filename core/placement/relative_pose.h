#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog {

/// How a structure lies among subjects: against where its neighbours say that it is, in a set's space, or against its
/// mean place in a joint model's.
struct RelativePose {
  std::size_t subjects = 1;
  Vec3 offset_mm = Vec3::Zero();  ///< the mean offset of its middle
  Vec3 turn_deg = Vec3::Zero();   ///< the turn about its middle: the axis times the angle, the mean
  double scale = 1;               ///< the geometric mean
  double offset_sd_mm = 0, turn_sd_deg = 0, scale_sd = 0;  ///< the spread; 0 of one subject
};

/// The axis times the angle, in degrees; the angle is 0…180°.
Vec3 turn_deg_of(const Eigen::Quaterniond& rotation);

/// The mean and the spread of similarities that carry a template from where its neighbours say to where it is.
/// `middle`: of the template, about which they turn. There must be one similarity.
RelativePose relative_pose(const std::vector<Similarity>& relative, const Vec3& middle);

/// The mean of several similarities: of rotations [Markley 2007], of scales the geometric, and of where they carry
/// `middle`. There must be one.
Similarity mean_similarity(const std::vector<Similarity>& of, const Vec3& middle);

/// The mean place of each template. `placed[s][k]` carries template k to where it lies in subject s; none: it is
/// not there. Subjects are brought together by similarities, in turn with the mean places [Gower 1975], until both
/// rest. The mean of the subjects' similarities is the identity, so that the places are upright and of middle size. A
/// template that is nowhere stays. The order of the subjects matters only to rounding.
std::vector<Similarity> mean_places(const std::vector<Points>& templates,
                                    const std::vector<std::vector<std::optional<Similarity>>>& placed);

}  // namespace homolog
