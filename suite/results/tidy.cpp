#include "suite/results/tidy.h"

#include <fmt/format.h>

#include <cmath>

#include "suite/results/csv.h"
#include "suite/results/exports.h"
#include "suite/store/catalog.h"
#include "suite/store/missing_work.h"
#include "suite/store/repetitions.h"

namespace physinv {
namespace {

using Real = std::optional<double>;
using Whole = std::optional<std::int64_t>;

template <std::string CaseInfo::*member>
std::string info_text(const TidyRow& r) {
  return r.info == nullptr ? "" : r.info->*member;
}

std::string profile(const TidyRow& r) {
  if (r.record != nullptr && !r.record->run.profile.empty())
    return r.record->run.profile;
  return info_text<&CaseInfo::profile>(r);
}

std::string precision(const TidyRow& r) {
  return r.info == nullptr ? "" : std::string(to_string(r.info->precision));
}

template <class Get>
Whole whole_of(const TidyRow& r, Get&& get) {
  return r.info == nullptr ? Whole() : static_cast<std::int64_t>(get(*r.info));
}
Whole n(const TidyRow& r) {
  return whole_of(r, [](const CaseInfo& i) { return i.n; });
}
Whole seed(const TidyRow& r) {
  return whole_of(r, [](const CaseInfo& i) { return i.seed; });
}

Real finite(double value) {
  return std::isfinite(value) ? Real(value) : Real();
}

Real loss(const TidyRow& r) {
  return r.has_numbers() ? finite(r.record->loss(*r.example)) : Real();
}

/// A method that counts nothing per example leaves zeros.
Real counted(const TidyRow& r, const Vector<double>& each) {
  const bool any = r.has_numbers() && (each.array() > 0).any();
  return any ? finite(each(*r.example)) : Real();
}
Real iterations(const TidyRow& r) {
  if (!r.has_numbers()) return {};
  const Real own = counted(r, r.record->example_iterations);
  return own ? own : static_cast<double>(r.record->iterations);
}
Real evaluations(const TidyRow& r) {
  if (!r.has_numbers()) return {};
  return counted(r, r.record->example_evaluations);
}

/// What a method from outside says of its work, in addition to what was
/// counted.
Real beside(const TidyRow& r, std::string_view array) {
  if (!r.has_numbers()) return {};
  const auto at = r.record->arrays.find(ArrayKey::own(array));
  const bool any = at != r.record->arrays.end() &&
                   at->second.size() == r.record->loss.size();
  return any ? finite(at->second.reshaped()(*r.example)) : Real();
}
Real claimed_iterations(const TidyRow& r) {
  return beside(r, "claimed_iterations");
}
Real claimed_evaluations(const TidyRow& r) {
  return beside(r, "claimed_evaluations");
}
Real overrun(const TidyRow& r) { return beside(r, "overrun"); }

template <double Seconds::*clock>
Real solving(const TidyRow& r) {
  return r.has_numbers() ? finite(solving_time(*r.record).*clock) : Real();
}

Whole threads(const TidyRow& r) {
  const bool known = r.record != nullptr && r.record->run.threads > 0;
  return known ? Whole(r.record->run.threads) : Whole();
}
Whole crowded(const TidyRow& r) {
  return r.has_numbers() ? Whole(r.record->crowded) : Whole();
}

constexpr TidyColumn kColumns[] = {
    {"case", [](const TidyRow& r) { return std::string(r.case_name); }},
    {"experiment", info_text<&CaseInfo::experiment>},
    {"method", info_text<&CaseInfo::method>},
    {"n", n},
    {"seed", seed},
    {"profile", profile},
    {"precision", precision},
    {"stage", [](const TidyRow& r) { return std::string(r.stage); }},
    {"example", [](const TidyRow& r) { return Whole(r.example); }},
    {"loss", loss},
    {"status", [](const TidyRow& r) { return std::string(r.status()); }},
    {"iterations", iterations},
    {"evaluations", evaluations},
    {"claimed_iterations", claimed_iterations},
    {"claimed_evaluations", claimed_evaluations},
    {"overrun", overrun},
    {"seconds", solving<&Seconds::wall>},
    {"cpu_seconds", solving<&Seconds::cpu>},
    {"threads", threads},
    {"crowded", crowded},
    {"message", [](const TidyRow& r) {
       return r.record == nullptr ? "" : r.record->message;
     }}};

std::string cell(const TidyColumn& column, const TidyRow& row) {
  struct Cell {
    const TidyRow& row;
    std::string operator()(TidyColumn::Text f) const {
      return csv_text(f(row));
    }
    std::string operator()(TidyColumn::Whole f) const {
      const auto value = f(row);
      return value ? std::to_string(*value) : "";
    }
    std::string operator()(TidyColumn::Real f) const {
      return csv_number(f(row));
    }
  };
  return std::visit(Cell{row}, column.value);
}

/// All examples of a stage; one row where their number is not known.
void add_stage(TidyRow r, const std::function<void(const TidyRow&)>& row) {
  if (r.info == nullptr) return row(r);
  for (Index i = 0; i < r.info->n; ++i) {
    r.example = i;
    row(r);
  }
}

}  // namespace

bool TidyRow::has_numbers() const {
  return record != nullptr && has_time(*record) && example &&
         *example < record->loss.size();
}

std::string_view TidyRow::status() const {
  if (record == nullptr) return "not run";
  if (!has_numbers()) return to_string(record->stop);
  if (!std::isfinite(record->loss(*example)))
    return to_string(Status::nonfinite);
  return to_string(record->status[static_cast<std::size_t>(*example)]);
}

std::span<const TidyColumn> tidy_columns() { return kColumns; }

void for_each_tidy_row(const Catalog& catalog,
                       const std::vector<CaseRecord>& cases,
                       const MissingWork& lacks,
                       const std::function<void(const TidyRow&)>& row) {
  for (const CaseRecord& c : cases)
    for (const StageRecord& s : c.stages)
      add_stage({.case_name = c.info.name,
                 .stage = s.stage,
                 .info = &c.info,
                 .record = &s},
                row);
  for (const auto& [name, stage] : stages_not_run(catalog, lacks)) {
    const auto info = catalog.knows_case(name)
                          ? std::optional(catalog.info_of(name))
                          : std::nullopt;
    add_stage(
        {.case_name = name, .stage = stage, .info = info ? &*info : nullptr},
        row);
  }
}

std::string tidy_csv(const Catalog& catalog,
                     const std::vector<CaseRecord>& cases,
                     const MissingWork& lacks) {
  std::string out;
  for (const TidyColumn& column : kColumns)
    out += fmt::format("{}{}", out.empty() ? "" : ",", column.name);
  for_each_tidy_row(catalog, cases, lacks, [&](const TidyRow& row) {
    const char* before = "\n";
    for (const TidyColumn& column : kColumns) {
      out += before;
      out += cell(column, row);
      before = ",";
    }
  });
  return out + "\n";
}

}  // namespace physinv
