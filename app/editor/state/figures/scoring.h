#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "app/editor/state/models/study_model.h"
#include "core/case/document.h"
#include "core/model/measures/score.h"

namespace homolog {

/// The title of the section that says how far the shown mesh is from a model.
inline constexpr const char* score_section = "Score";

/// Against which model the shown mesh is scored.
struct Scoring {
  bool by_file = false;                        ///< against a model's file, else against the open study
  std::filesystem::path file;                  ///< the file of the model that was read; empty: none was
  std::shared_ptr<const ShapeModel> of_file;   ///< null: none was read
  std::shared_ptr<const ShapeModel> of_study;  ///< the one by the study's other cases; null: none, or it is computed
  std::string no_model;                        ///< why the study gives none; empty: it does, or that is not known yet
  std::shared_ptr<const StudyModel> study;     ///< the study that `of_study` was asked of
  std::filesystem::path study_file;            ///< its
  std::string left_out;                        ///< the case that is not in it, by its name; empty: none
  std::shared_ptr<const VertexScalars> z;      ///< the z of the mesh that is worked on; null: it is not scored

  const std::shared_ptr<const ShapeModel>& model() const { return by_file ? of_file : of_study; }
};

/// How a mesh stands against a model.
struct ScoredShape {
  std::shared_ptr<const ShapeModel> model;
  std::string structure;                    ///< the structure that was asked for, by its id; empty: the first
  int frame = 0;                            ///< the frame of a cine
  std::shared_ptr<const Points> points;     ///< its vertices then
  std::shared_ptr<const ShapeScore> score;  ///< null: it cannot be scored
  std::string refusal;                      ///< why not: a sentence
  std::shared_ptr<const VertexScalars> z;   ///< its vertices' z; null: the model has no such structure
  bool operator==(const ScoredShape&) const = default;
};
/// Scores the structure of an id, which has a mesh at the document's frame, as the verb `score` does. With a joint
/// model all structures count that it has, by their names. `flipped`: left for right, as the study takes the case.
ScoredShape scored_shape(const std::shared_ptr<const ShapeModel>& model, const Document& document,
                         const std::string& structure, bool flipped = false);

}  // namespace homolog
