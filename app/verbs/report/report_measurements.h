#pragma once

#include <string>

#include "app/verbs/report/report_content.h"

namespace homolog {

// Measurements by a recipe along the modes of a page's model.

/// Measures the mean and the first modes of the content, which is otherwise whole. A part that the model lacks becomes
/// a warning. Errors: those of the recipe and of the template; cancelled.
Result<void> measure_page(const ReportVerb& verb, PageContent& content, Progress& progress);

/// For the page's plots: each measurement with its values and their texts, a row a mode.
Json measurements_json(const PageContent& content);
/// The section with the table; empty where nothing was measured.
std::string measurements_html(const PageContent& content);

}  // namespace homolog
