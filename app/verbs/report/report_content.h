#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/verbs/model/training.h"
#include "core/model/measures/measures.h"
#include "core/model/shape_model.h"
#include "core/model/shapes/recipe_shapes.h"

namespace homolog {

/// The arguments of `report`.
struct ReportVerb {
  TrainingVerb training;  ///< its files: shapes, studies, or one model
  std::filesystem::path out;
  std::string title;  ///< empty: the name of the first file
  int modes = 0;      ///< how many the page has; 0: those that hold 95 % of the variance, at most 10
  Eigen::Index samples = 1000;
  std::string recipe;              ///< the recipe to measure along the modes: a file, or the name of one that ships
  std::string the_template;        ///< lends landmarks and regions for that; empty: the first shape does
  std::filesystem::path left_out;  ///< a table of cases that are not among the shapes, with the reasons; empty: none
  bool without_names = false;      ///< cases are numbered: their names may be those of patients
};

/// A case of the page.
struct PageCase {
  std::string name, group;
  std::string doubt;                  ///< why somebody has to look at it; empty: nothing is known against it
  std::string excluded;               ///< why it is not in the model; empty: it is
  Eigen::Index shape = -1;            ///< its column in the shapes and the scores; −1: it is not in the model
  bool flipped = false;               ///< its study flips it left for right
  std::optional<double> size_mm;      ///< centroid size before it was aligned
  std::optional<double> doubt_mm;     ///< root mean square over its vertices
  std::optional<double> distance_sd;  ///< distance from the model of the others [left_out_distances]
};

/// All that a page shows.
struct PageContent {
  std::string title;
  std::string command;                           ///< without folders, whose names may be those of patients
  std::string template_name;                     ///< the template of a study; empty: none, or not known
  bool from_model = false;                       ///< the page is of a model's file: nothing is known beyond its modes
  ShapeModel model;                              ///< the model with exactly the modes that are shown
  Eigen::Index distance_modes = 0;               ///< how many of them the cases' distances are in; 0: none are known
  Eigen::VectorXd variances;                     ///< mm², of all modes that are known
  ShapeMatrix shapes;                            ///< 3n×M, aligned, mm; empty: the cases' places are not known
  std::vector<PageCase> cases;                   ///< those in the model in the order of `shapes`, then the others
  VertexScalars doubt_mm;                        ///< n: root mean square over the cases that have a doubt; or empty
  Eigen::Index doubt_cases = 0;                  ///< how many have one
  Eigen::Index flipped = 0;                      ///< how many shapes were flipped left for right
  Measures generalisation_rms, specificity_rms;  ///< at m = 1…M−2; empty: not known
  Eigen::Index samples = 0;                      ///< samples of the specificity
  std::shared_ptr<const Recipe> recipe;          ///< null: nothing is measured
  std::vector<ModeValues> along_modes;  ///< its values along the first modes, from −3 to 3 standard deviations
  std::vector<std::string> warnings;

  Eigen::Index cases_in_model() const;
  /// The names of the groups, in the order of their first cases.
  std::vector<std::string> groups() const;
};

/// The page of a study, as the window's button writes it. `the_template`: one with a recipe beside it, by which the
/// modes are measured; empty: they are not. Gives warnings.
Result<std::vector<std::string>> write_study_report(const std::filesystem::path& study, Alignment alignment,
                                                    const std::string& the_template, const std::filesystem::path& out,
                                                    Progress& progress);

/// Reads the model or the shapes, and computes what the page shows. Errors: those of read_model and of `train`; a model
/// without modes; points without faces; more modes than there are; cancelled.
Result<PageContent> page_content(const ReportVerb& verb, Progress& progress);

}  // namespace homolog
