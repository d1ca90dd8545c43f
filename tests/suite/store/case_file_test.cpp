// The file of a case: every bit, what it says of itself, older and newer ones.
#include "suite/store/case_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

void put(CaseFile& file, const StageRecord& record) {
  file.put_stage(record, hex64(arrays_hash(record)));
}

TEST(CaseFile, KeepsEveryBit) {
  TemporaryDirectory out;
  const auto info = sample_case("jpo", 8, 3);
  const auto data = sample_data(info);
  CaseFile file(info.name);
  file.put_data(data);
  for (Index k = 0; k < 2; ++k) put(file, sample_stage(info, k));
  const Folder folder(out.path());
  file.save(folder);

  const CaseFile back(folder, info.name);
  EXPECT_EQ(back.data().hash, data.hash);
  EXPECT_TRUE(same_bits(back.data().x, data.x));
  EXPECT_TRUE(same_bits(back.data().y, data.y));
  EXPECT_TRUE(same_bits(back.data().given, data.given));
  for (Index k = 0; k < 2; ++k) {
    const auto record = sample_stage(info, k);
    auto scalars = record;
    scalars.x.resize(0, 0), scalars.arrays.clear(), scalars.status.clear();
    back.read_stage(scalars, hex64(arrays_hash(record)));
    expect_same(record, scalars);
  }
}

About sample_about() {
  return {.problem = "sample",
          .paper = "Ann Ames: Title. Venue, 2022. arXiv:2203.10131",
          .arxiv = "2203.10131",
          .unknowns = {"angle, height", "rad, m"},
          .observations = {"y_1, y_2, y_3"},
          .given = {}};
}

TEST(CaseFile, DescribesItself) {
  auto info = sample_case("jpo", 4, 3);
  info.about = sample_about();
  auto stage = sample_stage(info, 1);
  CaseFile file(info.name);
  file.describe(info, sample_stage(info, 0));
  file.put_data(sample_data(info));
  stage.run.profile = "paper";
  file.describe(info, stage);  // the latest run counts
  put(file, stage);
  auto bytes = file.bytes();
  EXPECT_EQ(CaseFile(bytes, "path", info.name).about().paper, info.about.paper);
  EXPECT_EQ(CaseFile(bytes, "path", info.name).about().unknowns.unit, "rad, m");
  bytes.resize(bytes.size() - 16);
  const auto root = hdf5::open_image(bytes);
  EXPECT_EQ(hdf5::read_number(root, "schema"), kCaseVersion);
  EXPECT_EQ(hdf5::read_number(root, "n"), 4U);
  EXPECT_EQ(hdf5::read_number(root, "seed"), 3U);
  for (const auto& [name, text] : {std::pair("experiment", "jpo/sample"),
                                   {"problem", "sample"},
                                   {"method", "jpo"},
                                   {"precision", "f32"},
                                   {"profile", "paper"},
                                   {"revision", "abcdef+dirty"},
                                   {"arxiv", "2203.10131"},
                                   {"doi", "10.48550/arXiv.2203.10131"}})
    EXPECT_EQ(hdf5::read_attribute(root, name), text);
  const auto stages = hdf5::open_group(root, "stages");
  const auto group = hdf5::open_group(stages, "1_refine");
  EXPECT_EQ(hdf5::read_attribute(group, "stop"), "iterations");
  EXPECT_EQ(hdf5::note(group, "x").axes, "samples,unknowns");
  EXPECT_EQ(hdf5::note(group, "x").names, "angle, height");
  EXPECT_EQ(hdf5::rank(group, "loss"), 1);
  const auto curve = hdf5::open_group(group, "curve");
  EXPECT_EQ(hdf5::rank(curve, "x"), 3);
  EXPECT_EQ(hdf5::note(curve, "seconds").unit, "s");
  const auto arrays = hdf5::open_group(group, "arrays");
  EXPECT_EQ(hdf5::note(arrays, "parameters").axes, "networks,parameters");
  EXPECT_EQ(hdf5::note(arrays, "parameters").unit, "1");
  EXPECT_EQ(hdf5::note(arrays, "empty").axes, "") << "none of the suite's";
}

/// As version 1 had it: one text, arrays of other shapes.
std::string file_of_version_1(const CaseInfo& info, const StageRecord& r) {
  const auto file = hdf5::new_file();
  hdf5::write_attribute(file, "case", info.name);
  const auto data = sample_data(info);
  const auto own = hdf5::create_group(file, "data");
  hdf5::write_attribute(own, "hash", data.hash);
  hdf5::write(own, "x", data.x);
  hdf5::write(own, "y", data.y);
  hdf5::write(own, "given", data.given);
  const auto stages = hdf5::create_group(file, "stages");
  const auto group =
      hdf5::create_group(stages, fmt::format("{}_{}", r.position, r.stage));
  hdf5::write_attribute(group, "key", r.key);
  hdf5::write_attribute(group, "hash", hex64(arrays_hash(r)));
  hdf5::write(group, "x", r.x);
  hdf5::write(group, "loss", Batch<double>(r.loss));
  const hsize_t n = r.status.size();
  const hdf5::Handle shape(
      H5Screate_simple(1, &n, nullptr), H5Sclose, "make a shape");
  const hdf5::Handle options(
      H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a list");
  H5Pset_obj_track_times(options, false);
  const hdf5::Handle set(H5Dcreate2(group,
                                    "status",
                                    H5T_STD_U8LE,
                                    shape,
                                    H5P_DEFAULT,
                                    options,
                                    H5P_DEFAULT),
                         H5Dclose,
                         "create an array");
  H5Dwrite(
      set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, r.status.data());
  hdf5::write(group, "iterations", Batch<double>(r.example_iterations));
  hdf5::write(group, "evaluations", Batch<double>(r.example_evaluations));
  const auto curve = hdf5::create_group(group, "curve");
  hdf5::write(curve, "iteration", r.curve.iteration);
  hdf5::write(curve, "seconds", r.curve.seconds);
  hdf5::write(curve, "evaluations", r.curve.evaluations);
  hdf5::write(curve, "loss", r.curve.loss);
  hdf5::write(curve, "x", r.curve.x);
  const auto arrays = hdf5::create_group(group, "arrays");
  for (const auto& [name, array] : r.arrays) hdf5::write(arrays, name, array);
  const auto bytes = hdf5::image(file);
  return fmt::format("{}physinv:{:08x}", bytes, crc32c(bytes));
}

TEST(CaseFile, OfVersion1IsReadAndWrittenAnew) {
  const auto info = sample_case("jpo", 4, 3);
  const auto first = sample_stage(info, 0), second = sample_stage(info, 1);
  CaseFile file(file_of_version_1(info, first), "path", info.name);
  const auto expect_stage = [&](const StageRecord& stage) {
    auto back = stage;
    back.x.resize(0, 0), back.arrays.clear(), back.status.clear();
    file.read_stage(back, hex64(arrays_hash(stage)));
    expect_same(stage, back);
  };
  expect_stage(first);
  EXPECT_EQ(file.data().hash, sample_data(info).hash);
  file.describe(info, second);
  file.put_data(sample_data(info));
  put(file, second);
  expect_stage(first);
  expect_stage(second);
  EXPECT_TRUE(file.has_stage(first, hex64(arrays_hash(first))));
  auto bytes = file.bytes();
  bytes.resize(bytes.size() - 16);
  const auto root = hdf5::open_image(bytes);
  EXPECT_EQ(hdf5::read_number(root, "schema"), kCaseVersion);
  const auto stages = hdf5::open_group(root, "stages");
  for (const char* name : {"0_fit", "1_refine"})
    EXPECT_EQ(hdf5::rank(hdf5::open_group(stages, name), "loss"), 1);
}

/// Of a campaign that an earlier version of this program ran.
std::string file_of_version_2() {
  const auto bytes = read_file(PHYSINV_SOURCE_DIR
                               "/tests/fuzz/corpus/hdf5/billiards-bfgs-"
                               "described");
  return fmt::format("{}physinv:{:08x}", bytes, crc32c(bytes));
}

hdf5::Handle root_of(std::string bytes) {
  bytes.resize(bytes.size() - 16);
  return hdf5::open_image(std::move(bytes));
}

H5T_class_t type_of(hid_t group, const char* array) {
  const hdf5::Handle set(
      H5Dopen2(group, array, H5P_DEFAULT), H5Dclose, "open an array");
  return H5Tget_class(hdf5::Handle(H5Dget_type(set), H5Tclose, "read a type"));
}

TEST(CaseFile, OfVersion2IsReadAndWrittenAnew) {
  auto info = sample_case("bfgs", 4, 0);
  info.name = "jpo/billiards/bfgs/n=4/seed=0";
  info.stages = {"solve"};
  const auto old = root_of(file_of_version_2());
  ASSERT_EQ(hdf5::read_number(old, "schema"), 2U);
  const auto group =
      hdf5::open_group(hdf5::open_group(old, "stages"), "0_solve");
  ASSERT_EQ(type_of(group, "status"), H5T_ENUM);
  const auto hash = hdf5::read_attribute(group, "hash");
  StageRecord first;
  first.stage = "solve";
  first.key = hdf5::read_attribute(group, "key");
  CaseFile file(file_of_version_2(), "path", info.name);
  const auto expect_stage = [&] {
    StageRecord back = first;
    EXPECT_TRUE(file.has_stage(first, hash));
    file.read_stage(back, hash);  // its hash says that all are the same
    EXPECT_EQ(back.status.size(), 4U);
  };
  expect_stage();
  auto second = sample_stage(info, 0);
  second.position = 1, second.stage = "refine";
  const CaseData data = file.data();
  file.describe(info, second);
  file.put_data(data);
  put(file, second);
  expect_stage();
  const auto root = root_of(file.bytes());
  EXPECT_EQ(hdf5::read_number(root, "schema"), kCaseVersion);
  const auto stages = hdf5::open_group(root, "stages");
  const auto kept = hdf5::open_group(stages, "0_solve");
  EXPECT_EQ(type_of(kept, "status"), H5T_INTEGER);
  for (const char* text : {"key", "hash", "stop", "profile", "revision"})
    EXPECT_EQ(hdf5::read_attribute(kept, text),
              hdf5::read_attribute(group, text));
}

/// Other programs read fewer kinds than HDF5 has: texts of their exact length,
/// doubles and whole numbers, with none that stands for words.
TEST(CaseFile, HoldsWhatEveryReaderHas) {
  auto info = sample_case("jpo", 4, 3);
  info.about = sample_about();
  info.about.unknowns.unit = "\u00b5m, m";
  CaseFile file(info.name);
  file.describe(info, sample_stage(info, 0));
  file.put_data({});  // not drawn
  put(file, sample_stage(info, 0));
  int arrays = 0, texts = 0;
  const auto visit = [&](hid_t object, const hdf5::Handle& type) {
    const auto kind = H5Tget_class(type);
    EXPECT_TRUE(kind == H5T_FLOAT || kind == H5T_INTEGER || kind == H5T_STRING);
    if (kind != H5T_STRING || H5Iget_type(object) != H5I_ATTR) {
      EXPECT_NE(kind, H5T_STRING);
      ++arrays;
      return;
    }
    EXPECT_EQ(H5Tget_strpad(type), H5T_STR_NULLPAD);
    std::string text(H5Tget_size(type), '\0');
    H5Aread(object, type, text.data());
    EXPECT_FALSE(contains(text, std::string(1, '\0'))) << text;
    EXPECT_EQ(H5Tget_cset(type) == H5T_CSET_UTF8, contains(text, "\u00b5"));
    ++texts;
  };
  const auto look = [](hid_t root,
                       const char* name,
                       const H5O_info_t* what,
                       void* out) -> herr_t {
    const auto& visitor = *static_cast<decltype(visit)*>(out);
    const hdf5::Handle object(
        H5Oopen(root, name, H5P_DEFAULT), H5Oclose, "open an object");
    if (what->type == H5O_TYPE_DATASET)
      visitor(object, {H5Dget_type(object), H5Tclose, "read a type"});
    for (hsize_t k = 0; k < what->num_attrs; ++k) {
      const hdf5::Handle attribute(H5Aopen_by_idx(object,
                                                  ".",
                                                  H5_INDEX_NAME,
                                                  H5_ITER_INC,
                                                  k,
                                                  H5P_DEFAULT,
                                                  H5P_DEFAULT),
                                   H5Aclose,
                                   "open an attribute");
      visitor(attribute, {H5Aget_type(attribute), H5Tclose, "read a type"});
    }
    return 0;
  };
  const auto root = root_of(file.bytes());
  ASSERT_GE(H5Ovisit(root,
                     H5_INDEX_NAME,
                     H5_ITER_INC,
                     look,
                     const_cast<void*>(static_cast<const void*>(&visit))),
            0);
  EXPECT_GT(arrays, 12);
  EXPECT_GT(texts, 30);
  const auto data = hdf5::open_group(root, "data");
  EXPECT_FALSE(hdf5::has_attribute(data, "hash"));
  EXPECT_EQ(CaseFile(file.bytes(), "path", info.name).data().hash, "");
}

TEST(CaseFile, OfANewerVersionIsRefused) {
  const auto file = hdf5::new_file();
  hdf5::write_attribute(file, "case", "a/case");
  hdf5::write_attribute(file, "schema", kCaseVersion + 1);
  const auto bytes = hdf5::image(file);
  EXPECT_EQ(message_of<UnreadableInput>([&] {
              CaseFile(fmt::format("{}physinv:{:08x}", bytes, crc32c(bytes)),
                       "path",
                       "a/case");
            }),
            fmt::format("path: its version is {}, this program reads up to "
                        "{} (use the program that wrote it or a newer one)",
                        kCaseVersion + 1,
                        kCaseVersion));
}

TEST(CaseFile, EveryFlippedBitIsFound) {
  TemporaryDirectory out;
  const auto info = sample_case("jpo", 2, 3);
  CaseFile file(info.name);
  file.put_data(sample_data(info));
  put(file, sample_stage(info, 0));
  const fs::path path = out / case_file_name(info.name);
  file.save(Folder(out.path()));
  const auto bytes = read_file(path);
  for (std::size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / 199) {
    auto wrong = bytes;
    wrong[i] = static_cast<char>(wrong[i] ^ (1 << (i % 8)));
    const auto message =
        message_of<StoreError>([&] { CaseFile(wrong, path, info.name); });
    ASSERT_TRUE(contains(message, path.string() + " is damaged")) << i;
    ASSERT_THROW(CaseFile(bytes.substr(0, i), path, info.name), StoreError)
        << i;
  }
}

}  // namespace
}  // namespace physinv
