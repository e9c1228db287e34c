#include "app/verbs/report/report_methods.h"

#include <cmath>
#include <cstdio>
#include <map>

#include "app/version.h"

namespace homolog {

namespace {

constexpr const char* plus_minus = " \xc2\xb1 ";

/// Works in the order in which the text cites them.
class Citations {
 public:
  std::string cite(const std::string& work) {
    for (std::size_t k = 0; k < works_.size(); ++k)
      if (works_[k] == work) return "[" + std::to_string(k + 1) + "]";
    works_.push_back(work);
    return "[" + std::to_string(works_.size()) + "]";
  }
  std::string html() const {
    std::string list = "<ol class=\"works\">";
    for (const std::string& work : works_) list += "<li>" + html_text(work) + "</li>";
    return list + "</ol>";
  }

 private:
  std::vector<std::string> works_;
};

const std::string homolog_work = std::string("Homolog ") + version + ". The Homolog authors. Computer program.";
const std::string erdt_work =
    "Erdt M, Kirschner M, Wesarg S. Simultaneous Segmentation and Correspondence Establishment for Statistical Shape "
    "Models. In: Modelling the Physiological Human (3DPH 2009), LNCS 5903, 25\xe2\x80\x93"
    "35. Springer, 2009.";
const std::string gower_work =
    "Gower JC. Generalized Procrustes Analysis. Psychometrika 40, 33\xe2\x80\x93"
    "51, 1975.";
const std::string styner_work =
    "Styner MA, Rajamani KT, Nolte LP, et al. Evaluation of 3D Correspondence Methods for Model Building. In: "
    "Information Processing in Medical Imaging (IPMI 2003), LNCS 2732, 63\xe2\x80\x93"
    "75. Springer, 2003.";

std::string counted(Eigen::Index count, const std::string& one, const std::string& many) {
  return std::to_string(count) + ' ' + (count == 1 ? one : many);
}

std::string groups_sentence(const PageContent& content) {
  std::vector<std::string> words;
  for (const std::string& group : content.groups()) {
    Eigen::Index count = 0;
    for (const PageCase& one : content.cases) count += one.shape >= 0 && one.group == group ? 1 : 0;
    words.push_back(group + " (" + std::to_string(count) + ")");
  }
  return words.empty() ? "" : " The groups are " + listed(words, " and ") + '.';
}

std::string excluded_sentence(const PageContent& content) {
  std::map<std::string, Eigen::Index> reasons;
  Eigen::Index excluded = 0;
  for (const PageCase& one : content.cases)
    if (!one.excluded.empty()) ++reasons[one.excluded], ++excluded;
  if (excluded == 0) return "";
  std::vector<std::string> words;
  for (const auto& [reason, count] : reasons) words.push_back(std::to_string(count) + " (" + reason + ")");
  return ' ' + counted(excluded, "case was", "cases were") + " left out: " + listed(words, " and ") + '.';
}

std::string shapes_paragraph(const PageContent& content, Citations& works) {
  const Eigen::Index cases = content.cases_in_model();
  const std::string vertices = std::to_string(content.model.mean.size() / 3) + " vertices";
  const std::string program = "Homolog " + std::string(version) + ' ' + works.cite(homolog_work);
  std::string text = "The statistical shape model was ";
  if (content.from_model) {
    text += "read from a file by " + program + ". It has " + vertices;
    if (cases > 0)
      text += ", and the file holds the coefficients of " + counted(cases, "training shape", "training shapes");
  } else {
    text += "made with " + program;
    text += ", which implements Erdt et al. " + works.cite(erdt_work) + ", from " + counted(cases, "shape", "shapes");
    text += ". Each shape has " + vertices + ", and vertex i is the same place of the organ in each";
  }
  text += '.';
  if (!content.template_name.empty()) text += " The template of the study is " + content.template_name + '.';
  if (!content.model.parts.empty()) {
    std::vector<std::string> names;
    for (const StructurePart& part : content.model.parts) names.push_back(part.name);
    text += " It joins the structures " + listed(names, " and ") + '.';
  }
  return text + groups_sentence(content) + excluded_sentence(content);
}

std::string flipped_sentence(const PageContent& content) {
  if (content.flipped == 0) return "";
  return " Before, " + counted(content.flipped, "shape was", "shapes were") + " flipped left for right.";
}

std::string alignment_sentence(const PageContent& content, Citations& works) {
  if (!content.model.alignment) return "The file does not say how the shapes were aligned.";
  if (*content.model.alignment == Alignment::none) return "The shapes were not aligned: they vary as they lie.";
  const std::string procrustes = "The shapes were aligned by generalised Procrustes analysis " + works.cite(gower_work);
  return procrustes +
         (*content.model.alignment == Alignment::similarity
              ? ": translation, rotation, and scale to the mean centroid size."
              : ": translation and rotation; size is part of the model.") +
         flipped_sentence(content);
}

std::string modes_sentence(const PageContent& content) {
  const Eigen::VectorXd& variances = content.variances;
  const Eigen::Index holding = modes_holding(variances, 0.95);
  const Eigen::Index known = (variances.array() > 0).count();
  std::string text = " The first " + counted(holding, "mode holds", "modes hold") + " 95 % of the variance" +
                     (content.from_model ? " in the file" : "") + ", of " + std::to_string(known) + " in all (";
  std::vector<std::string> shares;
  for (Eigen::Index m = 0; m < std::min<Eigen::Index>(3, known); ++m)
    shares.push_back("mode " + std::to_string(m + 1) + ": " + fixed_text(100 * variances[m] / variances.sum(), 1) +
                     " %");
  const double spread = std::sqrt(variances.sum() / static_cast<double>(content.model.mean.size() / 3));
  return text + listed(shares, ", ") + "). The root mean square distance of a vertex from its mean place is " +
         fixed_text(spread, 2) + " mm.";
}

std::string measures_paragraph(const PageContent& content, Citations& works) {
  if (content.generalisation_rms.empty()) return {};
  const auto last = static_cast<Eigen::Index>(content.generalisation_rms.size());
  const Eigen::Index modes = std::min(last, modes_holding(content.variances, 0.95));
  const auto at = static_cast<std::size_t>(modes - 1);
  const Measured& general = content.generalisation_rms[at];
  const Measured& specific = content.specificity_rms[at];
  const auto both = [](const Measured& value) {
    return fixed_text(value.mean, 2) + plus_minus + fixed_text(value.standard_error, 2) + " mm";
  };
  return "Generalisation and specificity were measured as by Styner et al. " + works.cite(styner_work) +
         ", as root mean square distance over the vertices (mean" + plus_minus + "standard error). With " +
         counted(modes, "mode", "modes") + ", a shape that was left out lies " + both(general) +
         " from its reconstruction by the model of the others, and one of " + std::to_string(content.samples) +
         " random shapes of the model lies " + both(specific) + " from the nearest training shape.";
}

std::string doubt_paragraph(const PageContent& content) {
  if (content.doubt_cases == 0) return {};
  const double doubt = std::sqrt(content.doubt_mm.cwiseAbs2().mean());
  return "The fits say of each vertex how far its place is in doubt. The root mean square over vertices and " +
         counted(content.doubt_cases, "case", "cases") + " is " + fixed_text(doubt, 2) + " mm.";
}

std::string measurements_sentence(const PageContent& content) {
  if (!content.recipe) return {};
  return "The measurements of the recipe " + content.recipe->name + " were taken on the shapes of the model at " +
         "\xe2\x88\x92"
         "3 to 3 standard deviations of " +
         (content.along_modes.back().mode == 1
              ? std::string("its first mode.")
              : "each of its first " + std::to_string(content.along_modes.back().mode) + " modes.");
}

}  // namespace

std::string html_text(const std::string& text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string fixed_text(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::string methods_html(const PageContent& content) {
  Citations works;
  std::vector<std::string> paragraphs{shapes_paragraph(content, works)};
  const std::string alignment = alignment_sentence(content, works);
  paragraphs.push_back(
      alignment +
      " The model is x = mean + P b, where the columns of P are the principal components of the shapes' covariance "
      "(divisor M \xe2\x88\x92 1) " +
      works.cite(erdt_work) + '.' + modes_sentence(content));
  paragraphs.push_back(measures_paragraph(content, works));
  paragraphs.push_back(doubt_paragraph(content));
  paragraphs.push_back(measurements_sentence(content));
  std::string html;
  for (const std::string& one : paragraphs)
    if (!one.empty()) html += "<p>" + html_text(one) + "</p>\n";
  return html + works.html();
}

}  // namespace homolog
