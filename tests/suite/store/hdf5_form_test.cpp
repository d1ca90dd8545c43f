#include "suite/store/hdf5_form.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "suite/store/hdf5.h"
#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

/// Of a case as the suite writes it.
std::string case_image() {
  const auto info = sample_case("jpo", 3, 7);
  const TemporaryDirectory directory;
  CaseFile file(info.name);
  file.describe(info, sample_stage(info, 0));
  file.put_data(sample_data(info));
  for (const Index position : {0, 1, 0}) {  // once more: leaves gaps
    const StageRecord stage = sample_stage(info, position);
    file.put_stage(stage, hex64(arrays_hash(stage)));
  }
  file.save(Folder(directory.path()));
  std::string bytes = read_file(directory / case_file_name(info.name));
  bytes.resize(bytes.size() - 16);
  return bytes;
}

hdf5::Handle list(hsize_t size) {
  return {H5Screate_simple(1, &size, nullptr), H5Sclose, "make a shape"};
}

/// Made by whatever `put` does to an empty file.
template <class F>
std::string image_with(F&& put) {
  const auto file = hdf5::new_file();
  put(file);
  return hdf5::image(file);
}

template <class F>
std::string image_of_array(F&& choose) {
  return image_with([&](hid_t file) {
    const hdf5::Handle options(
        H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make a list");
    choose(options);
    const hdf5::Handle set(H5Dcreate2(file,
                                      "array",
                                      H5T_IEEE_F64LE,
                                      list(64),
                                      H5P_DEFAULT,
                                      options,
                                      H5P_DEFAULT),
                           H5Dclose,
                           "create an array");
  });
}

std::string with_attribute(hid_t type, hid_t shape) {
  return image_with([&](hid_t file) {
    const hdf5::Handle made(
        H5Acreate2(file, "of", type, shape, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose,
        "create an attribute");
  });
}

void expect_refused(const std::string& image, const std::string& what) {
  const auto message = message_of<StoreError>([&] { hdf5::check_form(image); });
  EXPECT_TRUE(contains(message, what)) << message;
}

TEST(Hdf5Form, TakesWhatTheSuiteWrites) {
  hdf5::check_form(case_image());
  hdf5::check_form(image_with([](hid_t) {}));
}

TEST(Hdf5Form, TakesGroupsOfAnySize) {
  for (const int count : {1, 8, 9, 256, 257, 600}) {
    hdf5::check_form(image_with([&](hid_t file) {
      for (int i = 0; i < count; ++i)
        hdf5::write(file, fmt::format("array {}", i), Batch<double>(1, 2));
      for (int i = 0; i < count; i += 3)
        hdf5::remove(file, fmt::format("array {}", i));
    }));
  }
}

TEST(Hdf5Form, RefusesWhatLeadsToOtherFiles) {
  expect_refused(image_with([](hid_t file) {
                   H5Lcreate_external(
                       "other.h5", "/", file, "link", H5P_DEFAULT, H5P_DEFAULT);
                 }),
                 "form");
  expect_refused(image_with([](hid_t file) {
                   H5Lcreate_soft(
                       "/nowhere", file, "link", H5P_DEFAULT, H5P_DEFAULT);
                 }),
                 "an address");
  expect_refused(image_of_array([](hid_t options) {
                   H5Pset_external(options, "/etc/passwd", 0, 512);
                 }),
                 "a message of type 7");
}

TEST(Hdf5Form, RefusesPartsThatNeedDecoding) {
  expect_refused(image_of_array([](hid_t options) {
                   const hsize_t chunk = 8;
                   H5Pset_chunk(options, 1, &chunk);
                   H5Pset_deflate(options, 9);
                 }),
                 "a fill value");
  expect_refused(image_of_array([](hid_t options) {
                   const double one = 1;
                   H5Pset_fill_value(options, H5T_NATIVE_DOUBLE, &one);
                 }),
                 "a fill value");
}

TEST(Hdf5Form, RefusesOtherEnumerationsAndNumbers) {
  expect_refused(image_with([](hid_t file) {
                   const hdf5::Handle type(
                       H5Tenum_create(H5T_STD_U8LE), H5Tclose, "make a type");
                   const std::uint8_t zero = 0;
                   H5Tenum_insert(type, "success", &zero);
                   const hdf5::Handle set(H5Dcreate2(file,
                                                     "status",
                                                     type,
                                                     list(4),
                                                     H5P_DEFAULT,
                                                     H5P_DEFAULT,
                                                     H5P_DEFAULT),
                                          H5Dclose,
                                          "create an array");
                 }),
                 "a type of numbers");
  const hdf5::Handle one(H5Screate(H5S_SCALAR), H5Sclose, "make a shape");
  for (const hid_t type : {H5T_STD_I64LE, H5T_STD_U64BE, H5T_IEEE_F64LE})
    expect_refused(with_attribute(type, one), "an attribute");
}

TEST(Hdf5Form, RefusesOtherListsAndTexts) {
  // Statuses of today, and those that older programs knew.
  for (const hsize_t size : {kStatuses.size(), std::size_t{4}})
    hdf5::check_form(with_attribute(H5T_STD_I32LE, list(size)));
  for (const hsize_t size : {kStatuses.size() + 1, std::size_t{0}})
    expect_refused(with_attribute(H5T_STD_I32LE, list(size)), "an attribute");
  for (const hid_t type : {H5T_STD_U32LE, H5T_IEEE_F64LE})
    expect_refused(with_attribute(type, list(4)), "an attribute");
  const hdf5::Handle padded(H5Tcopy(H5T_C_S1), H5Tclose, "make a type");
  H5Tset_size(padded, 8);
  H5Tset_strpad(padded, H5T_STR_SPACEPAD);
  const hdf5::Handle one(H5Screate(H5S_SCALAR), H5Sclose, "make a shape");
  expect_refused(with_attribute(padded, one), "an attribute");
}

TEST(Hdf5Form, RefusesGroupsInACircle) {
  expect_refused(image_with([](hid_t file) {
                   const auto inner = hdf5::create_group(file, "inner");
                   H5Lcreate_hard(
                       file, "/", inner, "up", H5P_DEFAULT, H5P_DEFAULT);
                 }),
                 "an object");
}

TEST(Hdf5Form, RefusesGroupsThatAreTooDeep) {
  expect_refused(image_with([](hid_t file) {
                   std::string path;
                   for (int depth = 0; depth < 40; ++depth)
                     hdf5::create_group(file, path += "/g");
                 }),
                 "a group");
}

TEST(Hdf5Form, EveryCutIsFound) {
  const std::string image = case_image();
  for (std::size_t size = 0; size < image.size(); size += 7)
    EXPECT_THROW(hdf5::check_form(image.substr(0, size)), StoreError) << size;
}

/// Reads everything there is; nothing but StoreError leaves it.
void read_all(const std::string& image) {
  const auto file = hdf5::open_image(image);
  const auto stages = hdf5::open_group(file, "stages");
  for (const auto& name : hdf5::names(stages)) {
    const auto stage = hdf5::open_group(stages, name);
    hdf5::read_attribute(stage, "key");
    for (const char* array : {"x", "loss", "iterations", "evaluations"})
      hdf5::read_batch(stage, array);
    hdf5::read_codes(stage, "status");
  }
}

TEST(Hdf5Form, NoWrongBytesReachTheLibrarysWeakPlaces) {
  const std::string image = case_image();
  std::mt19937 random(1);
  const std::string marks[] = {std::string(8, '\xff'),
                               std::string(8, '\0'),
                               std::string("\1\0\0\0\0\0\0\0", 8)};
  int refused = 0;
  for (int k = 0; k < 4000; ++k) {
    std::string wrong = image;
    for (auto count = 1 + random() % 4; count > 0; --count) {
      const std::size_t at = random() % (wrong.size() - 8);
      if (random() % 2 == 0) {
        wrong[at] = static_cast<char>(random());
      } else {
        wrong.replace(at / 8 * 8, 8, marks[random() % 3]);
      }
    }
    try {
      read_all(wrong);
    } catch (const StoreError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 400);  // most of the bytes are numbers
}

}  // namespace
}  // namespace physinv
