#include "app/verbs/help_page.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string_view>

namespace homolog {

namespace {

using Examples = std::array<const char*, 2>;

/// Two command lines of each verb, without the program's name.
const std::map<std::string_view, Examples> examples{
    {"demo", {"demo", "demo --headless -o demo/"}},
    {"sample", {"sample", "sample -o heart/"}},
    {"info", {"info ct.nii.gz", "info fits/case_1.ply --mask labels/case_1.nii.gz --label 1"}},
    {"replay", {"replay case_1.homolog -o case_1.ply", "replay cine.homolog --frame 4 -o frame_4.ply"}},
    {"compare",
     {"compare fits/case_1.ply --mask labels/case_1.nii.gz", "compare fits/case_1.ply --mesh expert/case_1.ply"}},
    {"measure", {"measure fits/ --csv sizes.csv", "measure fits/ --recipe vertebra --model L1.h5 --csv modes.csv"}},
    {"landmarks", {"landmarks fits/ -o landmarks.tps", "landmarks fits/ --vertices -o vertices.csv"}},
    {"observers", {"observers anna/ ben/", "observers anna.study.json ben.study.json --csv agreement.csv"}},
    {"label-map",
     {"label-map fits/case_1.ply --like ct.nii.gz -o organ.nii.gz",
      "label-map fits/case_1.ply --like ct.nii.gz --value 3 -o organ.nrrd"}},
    {"model", {"model fits/ -o kidney.h5.json", "model kidneys.study.json --without-doubtful --optimise -o kidney.h5"}},
    {"evaluate", {"evaluate fits/", "evaluate kidneys.study.json --modes 1,3,8 --csv measures.csv"}},
    {"score", {"score new.ply --model kidney.h5", "score patients/*.nii.gz --label L3 --model L3.h5 -o scores"}},
    {"test",
     {"test fits/ --covariates cases.csv --formula \"shape ~ group + age\"",
      "test kidneys.study.json --formula \"shape ~ log(size)\" --csv tables/"}},
    {"tets",
     {"tets kidney.vtu fits/ --template kidney.ply -o tets/",
      "tets femur.msh femurs.study.json --template femur.ply -o tets/ --json"}},
    {"mirror", {"mirror left.ply -o right.ply", "mirror upper.ply --plane axial -o lower.ply"}},
    {"phantom", {"phantom kidney --subject 1 -o phantom/", "phantom spine --subject 4 -o phantom/"}},
    {"picture", {"picture correspondence fits/ -o shapes.png", "picture modes kidney.h5.json -o modes.png"}},
    {"picture correspondence",
     {"picture correspondence fits/ -o shapes.png",
      "picture correspondence fits/ --view posterior --captions -o shapes.png"}},
    {"picture modes",
     {"picture modes kidney.h5.json -o modes.png", "picture modes kidney.h5.json --mode 1 -o mode1.gif"}},
    {"picture case",
     {"picture case case_1.homolog -o case_1.png", "picture case case_1.homolog --size 1600x1200 -o case_1.png"}},
    {"picture window",
     {"picture window case_1.homolog -o window.png",
      "picture window case_1.homolog --only coronal --captions -o coronal.png"}},
    {"picture study",
     {"picture study kidneys.study.json -o study.png",
      "picture study kidneys.study.json --only gallery -o gallery.png"}},
    {"picture map",
     {"picture map scores/patient_1.vtp --property z -o patient_1.pdf",
      "picture map kidney.h5.json --property effect_mm --values tables/landmarks.csv -o effect.svg"}},
    {"picture groups",
     {"picture groups kidneys.study.json --by group -o groups.pdf",
      "picture groups healthy/ --against ill/ --width-mm 85 -o groups.svg"}},
    {"picture score",
     {"picture score patient_1.ply --model kidney.h5.json -o patient_1.pdf",
      "picture score patient_1.ply --model kidney.h5.json --range=-3,3 --width-mm 85 -o patient_1.svg"}},
    {"picture plot",
     {"picture plot kidney.h5.json -o modes.pdf", "picture plot measures.csv --width-mm 85 -o measures.svg"}},
    {"report",
     {"report kidneys.study.json -o kidneys.html",
      "report vertebra.h5 --recipe vertebra --template vertebra.ply --title \"Healthy vertebrae\" -o vertebrae.html"}},
    {"convert", {"convert dicom/ ct.nii.gz", "convert fits/case_1.ply case_1.vtp"}},
    {"repair",
     {"repair ct-labels.nii.gz --templates trunk.set.json -o mended",
      "repair labels/ --templates built-in:spine -o mended"}},
    {"repair-mesh", {"repair-mesh scan.stl -o scan.ply", "repair-mesh scan.stl --holes all --genus 0 -o scan.ply"}},
    {"template",
     {"template labels/case_1.nii.gz --label 1 -o kidney.ply", "template --consensus labels/ --label 1 -o kidney.ply"}},
    {"set", {"set make trunk.seg.nrrd --all -o trunk.set.json", "set info trunk.set.json"}},
    {"set make",
     {"set make trunk.seg.nrrd --all -o trunk.set.json",
      "set make trunk.seg.nrrd --labels liver,spleen -o upper.set.json"}},
    {"set info", {"set info trunk.set.json", "set info trunk.set.json --json"}},
    {"set add",
     {"set add trunk.set.json second.seg.nrrd --labels pancreas",
      "set add built-in:spine ct.seg.nrrd --labels rib_left_12 -o back.set.json"}},
    {"set rename", {"set rename trunk.set.json liver Leber", "set rename built-in:spine sacrum S1 -o mine.set.json"}},
    {"set share",
     {"set share pelvis.set.json hip_left sacrum",
      "set share heart.set.json wall blood --within-mm 0.1 -o joined.set.json"}},
    {"fit",
     {"fit kidney.ply --mask labels/case_1.nii.gz --label 1 -o case_1.ply",
      "fit kidney.ply --mask labels/ --label 1 -o fits/"}},
    {"refine", {"refine case_1.homolog", "refine case_1.homolog -o case_1.ply"}},
    {"snap",
     {"snap fits/case_1.ply --image ct.nii.gz -o snapped.ply", "snap case_1.homolog --reach-mm 5 -o snapped.ply"}},
    {"propagate",
     {"propagate end_diastole.ply --image cine.nii.gz --frame 0 -o beat/",
      "propagate end_diastole.ply --image cine.nii.gz --frame 0 --reach-mm 4 -o beat/"}},
    {"verify", {"verify fits/case_1.ply --inputs data/", "verify kidney.h5.json --inputs data/ --json"}},
    {"bench", {"bench", "bench --mesh kidney.ply --json"}},
    {"study", {"study make cases.csv --template kidney.ply -o kidneys.study.json", "study bias labels/ --label 1"}},
    {"study make",
     {"study make labels/ --template kidney.ply -o kidneys.study.json",
      "study make cases.csv --template kidney.ply -o kidneys.study.json"}},
    {"study user",
     {"study user kidney.ply --mask labels/case_1.nii.gz -o case_1.homolog",
      "study user kidney.ply --mask labels/case_1.nii.gz --pulls 20 -o case_1.homolog"}},
    {"study schemes",
     {"study schemes built-in:kidney --phantoms 1 -o schemes/",
      "study schemes kidney.ply --mask labels/*.nii.gz -o schemes/"}},
    {"study contours",
     {"study contours kidney.ply --mask labels/case_1.nii.gz labels/case_2.nii.gz",
      "study contours L3.ply --mask labels.nii.gz --strokes strokes.nii.gz"}},
    {"study bias", {"study bias labels/ --label 1", "study bias bones/ --landmarks points/"}},
    {"study experts",
     {"study experts bones/ --landmarks points/",
      "study experts bones/ --landmarks points/ --templates 4 -o experts/"}},
    {"edit", {"edit ct.nii.gz labels.nii.gz --template kidney.ply", "edit case_1.homolog"}}};

/// What a checked value may be: "N (1 to 1024)" of "INT:INT in [1 - 1024]".
std::string type_in_words(const CLI::Option& option) {
  static const std::set<std::string> words{"--formula", "--paired", "--title", "--scheme", "--schemes", "--group",
                                           "--series",  "--modes",  "--size",  "--view",   "--shown",   "--only"};
  std::string type = option.get_type_name();
  const bool any_value = type.starts_with(':');  // read as text, and checked as what follows
  if (any_value) type.erase(0, 1);
  const auto colon = type.find(':');
  std::string kind = type.substr(0, colon), check = colon == std::string::npos ? "" : type.substr(colon + 1);
  if (any_value) check = kind, kind = kind.substr(0, kind.find(' '));
  if (const auto open = check.find('['); open != std::string::npos && check.find("OR") == std::string::npos) {
    std::string range = check.substr(open + 1, check.find(']') - open - 1);
    if (const auto dash = range.find(" - "); dash != std::string::npos) range.replace(dash, 3, " to ");
    check = "(" + range + ")";
  }
  if (const auto either = check.find(" OR "); either != std::string::npos && check.starts_with("({"))
    return check.substr(1, check.find('}')) + " or N";
  if (check == "NONNEGATIVE") check = "(0 or more)";
  if (check == "POSITIVE") check = "(above 0)";
  if (check == "DIR") return "FOLDER";
  if (check.starts_with("{")) return check;
  if (kind == "TEXT") return option.get_positional() ? "" : words.contains(option.get_name()) ? "NAME" : "PATH";
  if (kind == "INT" || kind == "UINT") kind = "N";
  if (kind == "FLOAT") kind = option.get_name().ends_with("-mm") ? "MM" : "X";
  return check.empty() ? kind : kind + " " + check;
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::ostringstream out;
    if (option->get_type_size() != 0) {
      if (const std::string type = type_in_words(*option); !type.empty()) out << ' ' << type;
      if (!option->get_default_str().empty()) out << ", else " << option->get_default_str();
      if (option->get_expected_max() == CLI::detail::expected_max_vector_size)
        out << " ...";
      else if (option->get_expected_min() > 1)
        out << " x " << option->get_expected();
      if (option->get_required() && !option->get_positional()) out << " (required)";
    }
    const auto list = [&out](const char* what, const std::set<CLI::Option*>& others) {
      if (others.empty()) return;
      out << what;
      for (const CLI::Option* other : others) out << ' ' << other->get_name();
    };
    list(", with", option->get_needs());
    list(", not with", option->get_excludes());
    return out.str();
  }
};

void dress_verb(CLI::App& verb, const std::shared_ptr<HelpFormatter>& formatter) {
  verb.formatter(formatter);
  if (const auto found = examples.find(full_name(verb)); found != examples.end()) {
    std::string lines = "Examples:";
    for (const char* line : found->second) lines += std::string("\n  homolog ") + line;
    verb.footer(lines);
  }
  for (CLI::App* part : verb.get_subcommands({})) dress_verb(*part, formatter);
}

}  // namespace

std::string full_name(const CLI::App& verb) {
  const CLI::App* parent = verb.get_parent();
  if (parent == nullptr) return {};
  const std::string above = full_name(*parent);
  return above.empty() ? verb.get_name() : above + " " + verb.get_name();
}

const CLI::App* verb_given(const CLI::App& app) {
  const CLI::App* verb = &app;
  while (!verb->get_subcommands().empty()) verb = verb->get_subcommands().front();
  return verb;
}

void dress_help(CLI::App& app) {
  dress_verb(app, std::make_shared<HelpFormatter>());
}

}  // namespace homolog
