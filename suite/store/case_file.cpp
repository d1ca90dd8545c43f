#include "suite/store/case_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

#include "suite/core/dataset.h"
#include "suite/store/checksum.h"
#include "suite/store/fields.h"
#include "suite/store/storable.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTrailer = "physinv:";
constexpr std::size_t kTrailerBytes = 16;

/// Of one row, a list.
Batch<double> read_array(hid_t group, const std::string& name) {
  if (hdf5::rank(group, name) == 2) return hdf5::read_batch(group, name);
  const auto list = hdf5::read_list(group, name);
  return Eigen::Map<const Batch<double>>(
      list.data(), 1, static_cast<Index>(list.size()));
}

std::vector<double> list_of(const Vector<double>& v) {
  return {v.data(), v.data() + v.size()};
}

/// What array_table.h says of an array. Others' arrays say nothing of theirs.
hdf5::Note note_of(const Arrays& arrays,
                   const std::string& name,
                   const Batch<double>& value) {
  const bool list = value.rows() == 1;
  const ArrayInfo* info = find_array(name, list, [&](std::string_view other) {
    return arrays.contains(ArrayKey::own(other));
  });
  if (info == nullptr) return {};
  const auto axes =
      list ? info->axes.substr(0, info->axes.find(',')) : info->axes;
  return {.axes = std::string(axes), .unit = std::string(info->unit)};
}

void write_text(hid_t parent, const char* name, const std::string& text) {
  if (!text.empty()) hdf5::write_attribute(parent, name, text);
}

/// What is not known has no attribute.
std::string read_text(hid_t parent, const char* name) {
  return hdf5::has_attribute(parent, name) ? hdf5::read_attribute(parent, name)
                                           : std::string();
}

Status status_of(std::int32_t code) {
  if (code < 0 || code > static_cast<std::int32_t>(kStatuses.back()))
    throw StoreError("the array status contains an invalid status");
  return static_cast<Status>(code);
}

std::string shape_text(const Batch<double>& b) {
  return fmt::format("{} x {}", b.cols(), b.rows());
}

/// Whole, and finite.
void require_sound(const CaseData& data) {
  for (const auto& [name, array] :
       {std::pair("x", &data.x), {"y", &data.y}, {"given", &data.given}}) {
    if (array->rows() > 0 && array->cols() != data.y.cols())
      throw StoreError(
          fmt::format("array data/{} has the shape {}; expected {} examples "
                      "(restore the file)",
                      name,
                      shape_text(*array),
                      data.y.cols()));
    if (!array->allFinite())
      throw StoreError(
          fmt::format("array data/{} contains values that are not finite "
                      "(restore the file)",
                      name));
  }
  const bool none = data.hash.empty() && data.y.size() == 0;  // not drawn
  if (!none && hex64(content_hash({data.x, data.y, data.given})) != data.hash)
    throw StoreError(
        "the hash of the data arrays is wrong (restore the file, or delete it "
        "to run the stages of this case again)");
}

std::string group_name(const StageRecord& r) {
  return fmt::format("{}_{}", r.position, r.stage);
}

void add(ArrayHash& hash, const Batch<double>& v) { hash.add(v); }
void add(ArrayHash& hash, const std::vector<double>& v) {
  hash.add(v.data(), static_cast<Index>(v.size()), 1);
}
void add(ArrayHash& hash, const std::vector<Status>& v) {
  hash.add(static_cast<std::uint64_t>(v.size()));
  for (const Status s : v) hash.add(static_cast<std::uint64_t>(s));
}

ArrayHash hash_results(const StageRecord& r) {
  ArrayHash hash;
  each_array(r, [&](const ArrayPlace& at, const auto& array) {
    if (at.unit != "s") add(hash, array);
  });
  for (const auto& [name, array] : r.arrays)
    hash.add(std::string_view(name)).add(array);
  return hash;
}

bool is_cube(const ArrayPlace& at) {
  return std::count(at.axes.begin(), at.axes.end(), ',') == 2;
}

void read(hid_t group, const ArrayPlace& at, std::vector<double>& to) {
  to = hdf5::read_list(group, at.name_text());
}
/// A number per example; (1, examples) in version 1.
void read(hid_t group, const ArrayPlace& at, Vector<double>& to) {
  const Batch<double> all = read_array(group, at.name_text());
  if (hdf5::rank(group, at.name_text()) == 2 && all.cols() != 1 &&
      all.size() > 0)
    throw StoreError(
        fmt::format("array {} is not a list of examples", at.name));
  to = all.reshaped();
}
void read(hid_t group, const ArrayPlace& at, Batch<double>& to) {
  to = is_cube(at) && hdf5::rank(group, at.name_text()) != 2
           ? hdf5::read_cube(group, at.name_text())
           : hdf5::read_batch(group, at.name_text());
}
void read(hid_t group, const ArrayPlace& at, std::vector<Status>& to) {
  to.clear();
  for (const auto code : hdf5::read_codes(group, at.name_text()))
    to.push_back(status_of(code));
}

void read_arrays(const hdf5::Handle& group, StageRecord& r) {
  hdf5::open_group(group, "curve");  // it is not a link
  each_array(
      r, [&](const ArrayPlace& at, auto& array) { read(group, at, array); });
  const auto arrays = hdf5::open_group(group, "arrays");
  r.arrays.clear();
  for (const auto& name : hdf5::names(arrays))
    r.arrays[ArrayKey::own(name)] = read_array(arrays, name);
}

hdf5::Note note_of(const ArrayPlace& at, const Meaning& unknowns) {
  if (at.unit != kUnknowns)
    return {.axes = std::string(at.axes), .unit = std::string(at.unit)};
  return {.axes = std::string(at.axes),
          .unit = unknowns.unit,
          .names = unknowns.names};
}

/// 1 had none.
std::uint64_t version_of(const hdf5::Handle& file) {
  return hdf5::has_attribute(file, "schema") ? hdf5::read_number(file, "schema")
                                             : 1;
}

/// The bytes without the trailer, once it agrees with them.
std::string verified(std::string bytes, const fs::path& path) {
  if (bytes.size() > kTrailerBytes) {
    const std::size_t size = bytes.size() - kTrailerBytes;
    const std::string_view all = bytes;
    if (all.substr(size) ==
        fmt::format("{}{:08x}", kTrailer, crc32c(all.substr(0, size)))) {
      bytes.resize(size);
      return bytes;
    }
  }
  throw StoreError(
      fmt::format("{} is damaged: its checksum is wrong (restore it, or delete "
                  "it to run the stages of this case again)",
                  path.string()));
}

}  // namespace

std::string case_file_name(const std::string& case_name) {
  std::string name = case_name;
  std::replace(name.begin(), name.end(), '/', '+');
  return name + ".h5";
}

std::uint64_t results_hash(const StageRecord& record) {
  return hash_results(record).value();
}

std::uint64_t arrays_hash(const StageRecord& record) {
  ArrayHash hash = hash_results(record);
  add(hash, record.curve.seconds);
  return hash.value();
}

/// Puts the file's name before what HDF5 complains about.
template <class F>
auto CaseFile::named(F&& body) const {
  try {
    return body();
  } catch (const StoreError& e) {
    throw StoreError(fmt::format("{}: {}", where_, e.what()));
  }
}

CaseFile::CaseFile(const std::string& case_name)
    : file_(hdf5::new_file()),
      case_name_(case_name),
      where_(case_file_name(case_name)) {
  hdf5::write_attribute(file_, "schema", kCaseVersion);
  hdf5::write_attribute(file_, "case", case_name);
  hdf5::create_group(file_, "stages");
}

CaseFile::CaseFile(const Folder& folder, const std::string& case_name)
    : CaseFile(folder.read(case_file_name(case_name), kLargestData),
               folder.path() / case_file_name(case_name),
               case_name) {}

CaseFile::CaseFile(std::string bytes,
                   const fs::path& path,
                   const std::string& case_name)
    : case_name_(case_name), where_(path.string()) {
  bytes = verified(std::move(bytes), path);
  named([&] {
    file_ = hdf5::open_image(std::move(bytes));
    const std::string name = hdf5::read_attribute(file_, "case");
    if (name != case_name)
      throw StoreError(fmt::format(
          "it contains the case {}, not {} (restore it)", name, case_name));
    const auto version = version_of(file_);
    if (version > kCaseVersion)
      throw UnreadableInput(
          fmt::format("{}: its version is {}, this program reads up to {} (use "
                      "the program that wrote it or a newer one)",
                      where_,
                      version,
                      kCaseVersion));
  });
}

void CaseFile::describe(const CaseInfo& info, const StageRecord& latest) {
  named([&] {
    about_ = info.about;
    if (version_of(file_) < kCaseVersion) renew();
    if (!hdf5::has_attribute(file_, "experiment")) describe_case(info);
    const std::string& own = latest.run.profile;
    for (const auto& [name, text] :
         {std::pair("profile", own.empty() ? &info.profile : &own),
          {"revision", &latest.revision}}) {
      hdf5::remove_attribute(file_, name);
      write_text(file_, name, *text);
    }
  });
}

void CaseFile::describe_case(const CaseInfo& info) const {
  write_text(file_, "experiment", info.experiment);
  write_text(file_, "problem", about_.problem);
  write_text(file_, "method", info.method);
  hdf5::write_attribute(file_, "n", static_cast<std::uint64_t>(info.n));
  hdf5::write_attribute(file_, "seed", info.seed);
  write_text(file_, "precision", std::string(to_string(info.precision)));
  write_text(file_, "paper", about_.paper);
  write_text(file_, "arxiv", about_.arxiv);
  if (!about_.arxiv.empty())
    write_text(file_, "doi", "10.48550/arXiv." + about_.arxiv);
}

About CaseFile::about() const {
  return named([&] {
    About about{.problem = read_text(file_, "problem"),
                .paper = read_text(file_, "paper"),
                .arxiv = read_text(file_, "arxiv")};
    if (!hdf5::has(file_, "data")) return about;
    const auto data = hdf5::open_group(file_, "data");
    for (const auto& [name, meaning] : {std::pair("x", &about.unknowns),
                                        {"y", &about.observations},
                                        {"given", &about.given}}) {
      auto note = hdf5::note(data, name);
      meaning->names = std::move(note.names);
      if (!note.unit.empty()) meaning->unit = std::move(note.unit);
    }
    return about;
  });
}

/// As this version writes it.
void CaseFile::renew() {
  CaseFile fresh(case_name_);
  fresh.about_ = about_;
  if (hdf5::has(file_, "data")) fresh.put_data(read_data());
  const auto stages = hdf5::open_group(file_, "stages");
  const auto kept = hdf5::open_group(fresh.file_, "stages");
  for (const auto& name : hdf5::names(stages)) {
    const auto old = hdf5::open_group(stages, name);
    const auto group = hdf5::create_group(kept, name);
    for (const char* text : {"key", "hash", "stop", "profile", "revision"})
      write_text(group, text, read_text(old, text));
    StageRecord record;
    read_arrays(old, record);
    fresh.put_arrays(group, record);
  }
  file_ = std::move(fresh.file_);
}

void CaseFile::put_data(const CaseData& data) {
  named([&] {
    if (hdf5::has(file_, "data")) {
      const auto old = hdf5::open_group(file_, "data");
      if (read_text(old, "hash") == data.hash) {
        if (!data_are_sound_) read_data();
        data_are_sound_ = true;
        return;
      }
      hdf5::remove(file_, "data");
    }
    const auto group = hdf5::create_group(file_, "data");
    write_text(group, "hash", data.hash);
    const auto put = [&](const char* name,
                         const Batch<double>& array,
                         const char* axes,
                         const Meaning& meaning) {
      hdf5::write(group,
                  name,
                  array,
                  {.axes = axes, .unit = meaning.unit, .names = meaning.names});
    };
    put("x", data.x, "samples,unknowns", about_.unknowns);
    put("y", data.y, "samples,observations", about_.observations);
    put("given", data.given, "samples,given", about_.given);
    data_are_sound_ = true;
  });
}

CaseData CaseFile::data() const {
  return named([&] { return read_data(); });
}

CaseData CaseFile::read_data() const {
  const auto group = hdf5::open_group(file_, "data");
  CaseData data{.hash = read_text(group, "hash"),
                .x = hdf5::read_batch(group, "x"),
                .y = hdf5::read_batch(group, "y"),
                .given = hdf5::read_batch(group, "given")};
  require_sound(data);
  return data;
}

void CaseFile::put_stage(const StageRecord& r, const std::string& hash) {
  named([&] {
    const auto stages = hdf5::open_group(file_, "stages");
    const std::string name = group_name(r);
    if (hdf5::has(stages, name)) hdf5::remove(stages, name);
    const auto group = hdf5::create_group(stages, name);
    hdf5::write_attribute(group, "key", r.key);
    hdf5::write_attribute(group, "hash", hash);
    hdf5::write_attribute(group, "stop", std::string(to_string(r.stop)));
    write_text(group, "profile", r.run.profile);
    write_text(group, "revision", r.revision);
    put_arrays(group, r);
  });
}

void CaseFile::put_arrays(const hdf5::Handle& group,
                          const StageRecord& r) const {
  const Index unknowns = r.x.rows();
  each_array(r, [&](const ArrayPlace& at, const auto& array) {
    using T = std::remove_cvref_t<decltype(array)>;
    if (at.name.starts_with("curve/") && !hdf5::has(group, "curve"))
      hdf5::create_group(group, "curve");
    const std::string name = at.name_text();
    const auto note = note_of(at, about_.unknowns);
    if constexpr (std::is_same_v<T, Batch<double>>) {
      const Index all = array.rows();
      // Examples whose unknowns are not known apart are one.
      const bool apart = unknowns > 0 && all % unknowns == 0 && all > 0;
      if (is_cube(at))
        return hdf5::write_cube(
            group, name, array, apart ? all / unknowns : 1, note);
    }
    if constexpr (std::is_same_v<T, Vector<double>>)
      hdf5::write(group, name, list_of(array), note);
    else
      hdf5::write(group, name, array, note);
  });
  const auto arrays = hdf5::create_group(group, "arrays");
  for (const auto& [key, array] : r.arrays) {
    if (array.rows() == 1) {
      hdf5::write(arrays,
                  key,
                  list_of(array.reshaped()),
                  note_of(r.arrays, key, array));
    } else {
      hdf5::write(arrays, key, array, note_of(r.arrays, key, array));
    }
  }
}

bool CaseFile::has_stage(const StageRecord& r, const std::string& hash) const {
  return named([&] {
    const auto stages = hdf5::open_group(file_, "stages");
    if (!hdf5::has(stages, group_name(r))) return false;
    const auto group = hdf5::open_group(stages, group_name(r));
    return hdf5::read_attribute(group, "key") == r.key &&
           hdf5::read_attribute(group, "hash") == hash;
  });
}

void CaseFile::read_stage(StageRecord& r, const std::string& hash) const {
  named([&] {
    const auto stages = hdf5::open_group(file_, "stages");
    const auto group = hdf5::open_group(stages, group_name(r));
    read_arrays(group, r);
    if (const auto flaw = flaw_of(r); !flaw.empty())
      throw StoreError(fmt::format(
          "array stages/{}/{} (restore the file)", group_name(r), flaw));
    if (hex64(arrays_hash(r)) != hash)
      throw StoreError(
          fmt::format("the hash of stage {} differs from its journal line "
                      "(delete the file to run the stages of this case again)",
                      r.stage));
  });
}

std::string CaseFile::bytes() const {
  std::string all = named([&] { return hdf5::image(file_); });
  return all += fmt::format("{}{:08x}", kTrailer, crc32c(all));
}

void CaseFile::save(const Folder& folder) const {
  folder.write(case_file_name(case_name_), bytes());
}

}  // namespace physinv
