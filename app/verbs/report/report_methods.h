#pragma once

#include <string>

#include "app/verbs/report/report_content.h"

namespace homolog {

/// Text as HTML shows it, in elements and in attributes.
std::string html_text(const std::string& text);
/// A number with this many digits behind the point.
std::string fixed_text(double value, int digits);

/// How the model was made and what its figures are, as paragraphs for a paper, with the works that they cite. HTML.
std::string methods_html(const PageContent& content);

}  // namespace homolog
