#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/template/template.h"
#include "core/template_making/faced_part.h"
#include "core/template_making/mesh_template.h"

namespace homolog {

struct FacedTemplateOptions {
  int label = 1;
  int frame = 0;
  int vertices = 2500;
  std::optional<double> closing_mm;  ///< without: ball_share of the label's size
};

struct FacedTemplate : MeshTemplate {
  std::vector<std::int32_t> cut;  ///< its vertices where the label map ends and the organ is closed flat
};

/// A template of the part of a label's surface that faces other labels, open at its rim: the label's closed boundary is
/// cut there, and the vertices are spread over it. Its distances are to that part. Errors: those of
/// label_boundary and faced_part; cancelled.
Result<FacedTemplate> make_faced_template(const Volume& mask, const FacedLabels& faced,
                                          const FacedTemplateOptions& options, Progress* progress = nullptr);

/// The file of such a template, which says how it was made and what it faces [faced_comment]. `source`: a file's name.
/// `labels`: what options.label stands for, where that is several.
MeshFile faced_template_file(const Mesh& mesh, const std::string& source, const FacedNames& faced,
                             const FacedTemplateOptions& options, const std::vector<int>& labels = {});

}  // namespace homolog
