#include "suite/evidence/claim_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include "suite/evidence/claim_conditions.h"

namespace physinv {
namespace {

struct CauseWord {
  std::string_view word;
  Verdict as;
};
constexpr std::array kCauses{
    CauseWord{"Fails: ", Verdict::not_reproduced},
    CauseWord{"Stronger: ", Verdict::stronger},
    CauseWord{"Weaker: ", Verdict::weaker},
    CauseWord{"Depends: ", Verdict::depends},
    CauseWord{"Contradiction: ", Verdict::contradiction},
    CauseWord{"Not run: ", Verdict::not_judged},
    CauseWord{"Reported: ", Verdict::reported}};
constexpr std::string_view kNote = "Note: ";
constexpr std::string_view kOr = " or ";
constexpr std::string_view kAnd = ", ";  ///< between experiments
constexpr std::string_view kKept = " (kept as ";

/// Takes a beginning away, if it is there.
bool skip(std::string_view& text, std::string_view beginning) {
  if (!text.starts_with(beginning)) return false;
  text.remove_prefix(beginning.size());
  return true;
}

struct Line {
  std::string_view text;
  int number;

  PlacedText::Place place(std::size_t k = 0) const {
    return {number, static_cast<int>(k) + 1};
  }
};

std::vector<Line> lines_of(std::string_view text) {
  std::vector<Line> lines;
  for (int number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    const auto last = line.find_last_not_of(" \r\t");
    line = line.substr(0, last == line.npos ? 0 : last + 1);
    lines.push_back({line, number});
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
  }
  return lines;
}

class Reader {
 public:
  Reader(std::string_view text, ClaimNames names, std::string_view only)
      : lines_(lines_of(text)), names_(std::move(names)), only_(only) {}

  std::vector<ClaimsOfExperiment> read() {
    while (next_ < lines_.size()) block();
    end_claim();
    std::vector<ClaimsOfExperiment> all;
    for (const Part& part : parts_)
      for (const std::string& name : part.experiments)
        all.push_back({name, part.claims});
    return all;
  }

 private:
  struct Part {
    std::vector<std::string> experiments;  ///< those that are asked for
    std::vector<Claim> claims;
  };

  std::vector<std::string> experiments_of(std::string_view heading) const {
    std::vector<std::string> all;
    while (!heading.empty()) {
      const auto name = heading.substr(0, heading.find(kAnd));
      if (only_.empty() || name == only_) all.emplace_back(name);
      heading.remove_prefix(
          std::min(name.size() + kAnd.size(), heading.size()));
    }
    return all;
  }

  /// The experiments of this part.
  bool is_asked_for() const { return !parts_.back().experiments.empty(); }

  [[noreturn]] static void fail(PlacedText::Place place, std::string what) {
    throw ExpressionError{place, std::move(what)};
  }

  void block() {
    const Line line = lines_[next_];
    std::string_view text = line.text;
    if (text.empty()) {
      ++next_;
    } else if (text.starts_with("```")) {
      definitions();
    } else if (skip(text, "# ")) {
      end_claim();
      parts_.push_back({experiments_of(text), {}});
      ++next_;
    } else if (text.starts_with("## ")) {
      end_claim();
      heading(line);
      ++next_;
    } else if (text.starts_with("- ")) {
      item(paragraph(2));
    } else {
      sentence(paragraph(0));
    }
  }

  /// The lines up to an empty one, or up to the next item, joined by spaces.
  PlacedText paragraph(std::size_t indent) {
    PlacedText joined;
    for (bool first = true; next_ < lines_.size(); ++next_, first = false) {
      const Line& line = lines_[next_];
      if (line.text.empty()) break;
      const bool begins = line.text.starts_with("- ") ||
                          line.text.starts_with("#") ||
                          line.text.starts_with("```");
      if (!first && begins) break;
      std::size_t from = line.text.find_first_not_of(' ');
      if (first) from = indent;
      if (!first && indent > 0 && from == 0)
        fail(line.place(), "a continuation line must be indented");
      if (!first) joined.append(" ", line.place());
      joined.append(line.text.substr(from), line.place(from));
    }
    return joined;
  }

  void definitions() {
    const Line opening = lines_[next_++];
    if (opening.text != "```claims")
      fail(opening.place(), "definitions must be in a block ```claims");
    PlacedText code;
    const auto take = [&] {
      if (!code.text.empty()) define(code, names_);
      code = {};
    };
    for (; next_ < lines_.size(); ++next_) {
      const Line& line = lines_[next_];
      if (line.text == "```") {
        take();
        ++next_;
        return;
      }
      if (!line.text.starts_with(' ')) take();
      code.append(line.text, line.place());
    }
    fail(opening.place(), "this block has no end");
  }

  /// "## P2 (App. C.2) from quick, no gate"
  void heading(const Line& line) {
    if (parts_.empty())
      fail(line.place(), "a heading '# <experiment>' is missing before it");
    std::string_view text = line.text.substr(3);
    claim_.emplace();
    const auto id = text.substr(0, text.find(' '));
    claim_->id = id;
    text.remove_prefix(id.size());
    const auto column = [&] { return line.text.size() - text.size(); };
    if (skip(text, " (")) {
      const auto end = text.rfind(')');
      if (end == text.npos)
        fail(line.place(column()), "the place in the paper has no end");
      claim_->where = text.substr(0, end);
      text.remove_prefix(end + 1);
    }
    if (skip(text, " from ")) {
      const auto profile = text.substr(0, text.find(','));
      claim_->from = profile;
      text.remove_prefix(profile.size());
      if (text == ", no gate") text.remove_prefix(1);
    }
    if (skip(text, " no gate")) claim_->gates = false;
    if (!text.empty())
      fail(line.place(column()),
           "a heading is '## ID (place) from profile, no gate'");
  }

  void sentence(const PlacedText& paragraph) {
    if (!claim_) {
      if (parts_.empty())
        fail(paragraph.place(0), "a document must begin with '# <experiment>'");
      return;  // for readers
    }
    std::string_view text = paragraph.text;
    if (skip(text, kNote)) {
      set_once(claim_->note, text, paragraph);
      return;
    }
    for (const CauseWord& c : kCauses)
      if (skip(text, c.word)) {
        set_once(claim_->cause.why, text, paragraph);
        claim_->cause.as = c.as;
        if (!is_asked_for()) return;
        cause_ = paragraph.part(c.word.size(), paragraph.text.size());
        claim_->cause.numbers = numbers_of(cause_, names_);
        return;
      }
    set_once(claim_->says, text, paragraph);
  }

  static void set_once(std::string& to,
                       std::string_view text,
                       const PlacedText& paragraph) {
    if (!to.empty())
      fail(paragraph.place(0),
           "a claim has one sentence; the text after it must begin with Note:, "
           "Fails:, Stronger:, Weaker:, Depends:, Contradiction:, Not run: or "
           "Reported:");
    to = text;
  }

  /// "label: `expression` or label: `expression`"
  void item(const PlacedText& whole) {
    if (!claim_ || !is_asked_for()) return;  // without a claim, for readers
    auto& to =
        claim_->cause.why.empty() ? claim_->conditions : claim_->cause.shown_by;
    std::vector<Condition> alternatives;
    for (std::size_t from = 0; from < whole.text.size();) {
      if (from > 0) {
        if (whole.text.compare(from, kOr.size(), kOr) != 0)
          fail(whole.place(from), "'or' is missing here");
        from += kOr.size();
      }
      const auto open = whole.text.find('`', from),
                 close = open == std::string::npos
                             ? open
                             : whole.text.find('`', open + 1);
      if (close == std::string::npos)
        fail(whole.place(from),
             "a condition is 'label: `expression`', with both backticks");
      const auto one = conditions(whole, from, open, close);
      from = close + 1;
      if (alternatives.empty() && from == whole.text.size()) {
        std::copy(one.begin(), one.end(), std::back_inserter(to));
        return;
      }
      if (one.size() != 1)
        fail(whole.place(open), "alternatives must be single conditions");
      alternatives.push_back(one.front());
    }
    if (alternatives.empty()) fail(whole.place(0), "a condition is missing");
    Condition all = alternatives.back();
    for (auto k = alternatives.size() - 1; k-- > 0;) {
      const bool stages = alternatives[k].of_stages && all.of_stages;
      all = either(alternatives[k], all);
      all.of_stages = stages;
    }
    to.push_back(std::move(all));
  }

  std::vector<Condition> conditions(const PlacedText& whole,
                                    std::size_t from,
                                    std::size_t open,
                                    std::size_t close) const {
    std::string_view label =
        std::string_view(whole.text).substr(from, open - from);
    if (label.ends_with(": ")) {
      label.remove_suffix(2);
    } else if (!label.empty()) {
      fail(whole.place(open), "a label must end with ': '");
    }
    std::string text;
    if (const auto kept = label.rfind(kKept);
        kept != label.npos && label.ends_with(')')) {
      text = label.substr(0, kept);
      label = label.substr(kept + kKept.size());
      label.remove_suffix(1);
    }
    auto all =
        conditions_of(std::string(label), whole.part(open + 1, close), names_);
    if (!text.empty())
      for (Condition& c : all) c = shown_as(std::move(c), text);
    return all;
  }

  /// Does a condition of the claim pass, or perhaps of its cause?
  template <class F>
  bool any_condition(bool of_cause, F&& passes) const {
    const auto any = [&](const std::vector<Condition>& all) {
      return std::any_of(all.begin(), all.end(), passes);
    };
    return any(claim_->conditions) || (of_cause && any(claim_->cause.shown_by));
  }

  /// Are the words in the claim's sentence, note or labels?
  bool names(const std::string& words) const {
    const auto in = [&](const std::string& text) {
      return text.find(words) != std::string::npos;
    };
    return in(claim_->says) || in(claim_->note) ||
           any_condition(false, [&](const Condition& c) {
             return in(c.label) || in(c.shown);
           });
  }

  /// What numbers in the cause ask of the rest of the claim.
  void check_cause() const {
    for (const CauseNumber& n : claim_->cause.numbers) {
      const auto is_its = [&](const Condition& c) {
        return c.label == n.label;
      };
      if (n.kind == CauseNumber::Kind::setting && n.of.empty() &&
          !names(n.text))
        fail(cause_.place(n.begin),
             fmt::format(
                 "neither the sentence, the note nor a label contains the "
                 "setting '{}'; add the study's name to a setting of a study",
                 n.text));
      if (!n.label.empty() && !any_condition(true, is_its))
        fail(cause_.place(n.begin),
             fmt::format("the claim has no condition '{}'", n.label));
    }
  }

  void end_claim() {
    if (claim_) check_cause();
    if (claim_) parts_.back().claims.push_back(std::move(*claim_));
    claim_.reset();
  }

  std::vector<Line> lines_;
  ClaimNames names_;
  std::string_view only_;
  std::size_t next_ = 0;
  std::vector<Part> parts_;
  std::optional<Claim> claim_;
  PlacedText cause_;  ///< of this claim
};

}  // namespace

std::vector<ClaimsOfExperiment> read_claims(std::string_view text,
                                            const std::string& file,
                                            ClaimNames names,
                                            std::string_view experiment) {
  try {
    return Reader(text, std::move(names), experiment).read();
  } catch (const ExpressionError& e) {
    throw ClaimDocumentError(fmt::format(
        "{}:{}:{}: {}", file, e.place.line, e.place.column, e.what));
  }
}

}  // namespace physinv
