#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/settings.h"
#include "app/editor/work/study_template.h"
#include "app/editor/work/worker.h"
#include "core/model/shapes/study.h"
#include "core/template/template.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

/// The work that the worklist did: it made cases for the scans of a folder, or fitted one case.
struct WorklistDone {
  std::vector<StudyCase> added;
  std::string fitted;  ///< name of the case that was fitted, or could not be; empty: none
  std::filesystem::path file;
  std::string doubt;                  ///< why a person has to look at it; empty: no doubt
  std::string fault;                  ///< why it could not be fitted, as a sentence; empty: it was
  std::string map;                    ///< the map of which a label has to be chosen first; empty: none has
  std::vector<Segment> labels;        ///< labels that this map holds
  std::optional<StudyTemplate> made;  ///< a template of the label maps of `study`
  std::filesystem::path study;
  std::vector<std::string> warnings;  ///< sentences
};

/// The things that cases of scans begin with.
struct CaseStart {
  std::filesystem::path cases;                   ///< folder of their files
  std::shared_ptr<const Template> the_template;  ///< null: that of `template_source`
  bool mirrored = false;                         ///< each begins with the template of the other side
  std::vector<std::filesystem::path> known;      ///< files of the study's cases: these are never made again
  std::string template_source;                   ///< the template's source, if the template is null
  /// How a case of an image, and of its label map where it has one, is made, for its first line; empty: by hand.
  std::function<Result<std::string>(const std::filesystem::path& file, const std::vector<std::filesystem::path>& scan)>
      record{};
};

/// Makes a case for every scan in a folder, or for each of several files: see Worklist::add. Errors: no scan there,
/// cancelled.
Result<WorklistDone> cases_of_scans(const std::vector<std::filesystem::path>& paths, const CaseStart& start,
                                    Progress& progress);

/// Makes cases for the scans and label maps of a folder and a template of their label maps, and fits those that wait,
/// beside the window. Called from the window's thread only.
class Worklist {
 public:
  /// `wake` is called from the thread when something is done.
  explicit Worklist(std::function<void()> wake) : worker_(std::move(wake)) {}

  /// Makes a case for every scan in a folder, or for each of several files. A scan is an image, with the label map on
  /// its voxels where there is one, or a label map alone. No case file is overwritten. One of the same image that is
  /// there already is taken where the study has it or where it begins alike; else the new case gets another name.
  void add(const std::vector<std::filesystem::path>& paths, CaseStart start);
  /// Makes a consensus template of the cases' label maps: see make_study_template.
  void make_template(const std::vector<StudyCase>& cases, const FitSettings& settings,
                     const std::filesystem::path& file, const std::filesystem::path& study);
  /// Fits the template of each case to its label map, one after the other. The label is that of the settings, or the
  /// only one that a map holds; where a map holds several and the settings name none, it is left until one is chosen.
  void fit(const std::vector<StudyCase>& cases, const FitSettings& settings);
  /// Gives up what goes on; what was fitted stays so.
  void cancel();
  bool busy() const { return worker_.busy(); }
  /// "Fitting case_7", and how much of all is done, 0 … 1.
  std::string what() const;
  double fraction() const;
  std::optional<Result<WorklistDone>> take();
  void finish() { worker_.finish(); }

 private:
  std::size_t asked_ = 0, done_ = 0;  ///< jobs
  Worker<WorklistDone> worker_;
};

}  // namespace homolog
