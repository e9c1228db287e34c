#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/editor/update/commands/file_commands.h"
#include "app/editor/update/commands/looks/setting.h"
#include "app/editor/update/results/worklist.h"

namespace homolog {

class Outbox;
struct ControlsContext;

// The Models mode's work on the study: its files, its cases, its worklist, its measures.

void open_study(Editing& editing, const std::filesystem::path& path);
using OpenStudy = EditingCall<"open study", "path", open_study>;
void new_study(Editing& editing, const std::filesystem::path& path);
using NewStudy = EditingCall<"new study", "path", new_study>;
/// The study continues under another name.
void save_study_as(Editing& editing, const std::filesystem::path& path);
using SaveStudyAs = EditingCall<"save study as", "path", save_study_as>;
void open_phantom_study(Editing& editing, Organ organ);
using OpenPhantomStudy = EditingCall<"open phantom study", "organ", open_phantom_study>;
/// Gives up a study that is read, or a case that is made for it.
void cancel_study_file(Editing& editing, const std::string& subject);
using CancelStudyFile = EditingCallLogged<Logged::never, "cancel study file", "subject", cancel_study_file>;
struct ExportModel : FileCommand {
  static constexpr const char* key = "export model";
  void run(Editing& editing) const;
};
struct ExportEvaluation : FileCommand {
  static constexpr const char* key = "export measures";
  void run(Editing& editing) const;
};
/// Volume, area and distances between landmarks of every case.
struct ExportSizes : FileCommand {
  static constexpr const char* key = "export sizes";
  void run(Editing& editing) const;
};
/// The landmarks of all cases in one file, .tps or .csv.
struct ExportLandmarkTable : FileCommand {
  static constexpr const char* key = "export landmark table";
  void run(Editing& editing) const;
};
/// Compares the study's cases with those of the same names in another observer's study.
struct CompareObservers : FileCommand {
  static constexpr const char* key = "compare observers";
  void run(Editing& editing) const;
};
void cancel_comparison(Editing& editing);
using CancelObservers = PlainEditingCall<"cancel comparison", cancel_comparison>;
struct ExportObservers : FileCommand {
  static constexpr const char* key = "export observers";
  void run(Editing& editing) const;
};
struct ExportPlots : FileCommand {
  static constexpr const char* key = "export plots";
  void run(Editing& editing) const;
};
/// The study's model as one page for a browser.
struct ExportReport : FileCommand {
  static constexpr const char* key = "export report";
  void run(Editing& editing) const;
};
/// Asks for a folder to export the shapes to; empty: each in the format it was imported from.
struct ChooseShapesFolder {
  static constexpr const char* key = "choose shapes folder";
  static constexpr Logged logged = Logged::never;
  std::string extension, name;
  void spell(Fields& line);
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
/// Writes every shape of the study, flipped ones flipped, into a folder; see write_shapes.
struct ExportShapes {
  static constexpr const char* key = "export shapes";
  std::filesystem::path folder;
  std::string extension;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
void start_evaluation(Editing& editing);
using StartEvaluation = PlainEditingCall<"start evaluation", start_evaluation>;
void cancel_evaluation(Editing& editing);
using CancelEvaluation = PlainEditingCallLogged<Logged::never, "cancel evaluation", cancel_evaluation>;

// Cases.

struct AddCases {
  static constexpr const char* key = "add cases";
  std::vector<std::filesystem::path> paths;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Makes a case for every scan and label map: of a folder, for which one file stands too, or of several files.
struct AddScans {
  static constexpr const char* key = "add scans";
  std::vector<std::filesystem::path> paths;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Fits the cases that wait to their label maps.
struct FitWaiting {
  static constexpr const char* key = "fit waiting";
  int label = 0;            ///< 0: asked for where a map holds several
  bool all_labels = false;  ///< all labels together, in place of one
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Makes a consensus template of the label maps of the study's cases.
struct MakeStudyTemplate : FileCommand {
  static constexpr const char* key = "make study template";
  int label = 0;            ///< 0: asked for where a map holds several
  bool all_labels = false;  ///< all labels together, in place of one
  void spell(Fields& line);
  void run(Editing& editing) const;
};
using CancelWorklist = PlainEditingCallLogged<Logged::never, "cancel worklist", cancel_worklist>;
/// The case on the screen is done, and the next one of the study is opened.
using OpenNextCase = PlainEditingCall<"open next case", open_next_case>;
/// Opens a case of the study in the case mode, at a vertex with the Slide tool where one is given; a mesh becomes a
/// case file first.
struct OpenCaseOfStudy {
  static constexpr const char* key = "open case of study";
  static constexpr Logged logged = Logged::never;
  std::string name;
  std::optional<Eigen::Index> vertex;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct SetCaseState {
  static constexpr const char* key = "set case state";
  std::string name;
  CaseState to = CaseState::to_do;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct SetCaseText {
  static constexpr const char* key = "set case text";
  std::string name, field, text;
  void spell(Fields& line);
  void run(EditorState& state) const;
};

}  // namespace homolog
