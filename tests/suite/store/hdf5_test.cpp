#include "suite/store/hdf5.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

/// A thousand of anything: room for one is not enough.
hdf5::Handle thousand() {
  const hsize_t count = 1000;
  return {H5Screate_simple(1, &count, nullptr), H5Sclose, "make a shape"};
}

hdf5::Handle text_type(std::size_t size) {
  hdf5::Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a type");
  H5Tset_size(type, size);
  return type;
}

void put_attribute(hid_t parent, const char* name, hid_t type, hid_t space) {
  const hdf5::Handle attribute(
      H5Acreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose,
      "create an attribute");
}

void put_array(hid_t parent,
               const char* name,
               hid_t type,
               const std::vector<hsize_t>& shape) {
  const hdf5::Handle space(
      H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      H5Sclose,
      "make a shape");
  const hdf5::Handle set(
      H5Dcreate2(
          parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose,
      "create an array");
}

TEST(Hdf5, ReadsWhatItWrote) {
  const auto written = hdf5::new_file();
  hdf5::write_attribute(written, "some", "text");
  hdf5::write_attribute(written, "none", "");
  const Batch<double> batch = Batch<double>::Random(3, 4);
  hdf5::write(written, "batch", batch);
  hdf5::write(written, "empty", Batch<double>(0, 4));
  EXPECT_THROW(hdf5::write_attribute(written, "some", "again"), StoreError);
  hdf5::remove_attribute(written, "some");
  hdf5::remove_attribute(written, "other");
  hdf5::write_attribute(written, "some", "other text");
  hdf5::write_attribute(written, "seed", ~std::uint64_t{0});
  hdf5::write(written,
              "noted",
              std::vector<double>{1, 2},
              {.axes = "samples", .unit = "s"});
  hdf5::write(written, "ends", std::vector{Status::maxiter, Status::ftol});
  hdf5::write_cube(written, "cube", batch.topRows(2), 2);
  const auto file = hdf5::open_image(hdf5::image(written));
  EXPECT_EQ(hdf5::read_attribute(file, "some"), "other text");
  EXPECT_EQ(hdf5::read_number(file, "seed"), ~std::uint64_t{0});
  EXPECT_FALSE(hdf5::has_attribute(file, "other"));
  EXPECT_EQ(hdf5::note(file, "noted").axes, "samples");
  EXPECT_EQ(hdf5::note(file, "noted").unit, "s");
  EXPECT_EQ(hdf5::note(file, "noted").names, "");
  EXPECT_EQ(hdf5::rank(file, "cube"), 3);
  EXPECT_EQ(hdf5::read_cube(file, "cube"), batch.topRows(2));
  EXPECT_EQ(hdf5::read_attribute(file, "none"), "");
  EXPECT_EQ(hdf5::read_batch(file, "batch"), batch);
  EXPECT_EQ(hdf5::read_batch(file, "empty").cols(), 4);
  EXPECT_EQ(hdf5::read_codes(file, "ends"), (std::vector<std::int32_t>{1, 4}));
}

TEST(Hdf5, AttributesAreOneTextOfFixedLength) {
  const auto file = hdf5::new_file();
  const hdf5::Handle one(H5Screate(H5S_SCALAR), H5Sclose, "make a shape");
  put_attribute(file, "numbers", H5T_NATIVE_DOUBLE, thousand());
  put_attribute(file, "number", H5T_NATIVE_DOUBLE, one);
  put_attribute(file, "texts", text_type(8), thousand());
  put_attribute(file, "pointer", text_type(H5T_VARIABLE), one);
  for (const char* name : {"numbers", "number", "texts", "pointer"}) {
    EXPECT_EQ(
        message_of<StoreError>([&] { hdf5::read_attribute(file, name); }),
        fmt::format("attribute {} is not one text of fixed length", name));
    EXPECT_EQ(message_of<StoreError>([&] { hdf5::read_number(file, name); }),
              fmt::format("attribute {} is not one whole number", name));
  }
}

TEST(Hdf5, LongTextsStandInSeveralAttributes) {
  const auto written = hdf5::new_file();
  std::string text = "a";  // so that a character would be cut in two
  while (text.size() < 1000000) text += "\u00fc";
  hdf5::write_attribute(written, "names", "short");
  hdf5::remove_attribute(written, "names");
  hdf5::write_attribute(written, "names", text);
  const auto file = hdf5::open_image(hdf5::image(written));
  EXPECT_EQ(hdf5::read_attribute(file, "names"), text);
  const auto last = hdf5::read_attribute(file, "names_17");
  EXPECT_EQ(last.substr(0, 2), "\u00fc");
  EXPECT_FALSE(hdf5::has_attribute(file, "names_18"));
  hdf5::remove_attribute(file, "names");
  EXPECT_FALSE(hdf5::has_attribute(file, "names_17"));
  hdf5::write_attribute(file, "names", std::string(120000, 'a'));
  EXPECT_EQ(hdf5::read_attribute(file, "names_2"), std::string(60000, 'a'));
  EXPECT_FALSE(hdf5::has_attribute(file, "names_3"));
}

TEST(Hdf5, ArraysHaveTheTypeAndRankTheyWereWrittenWith) {
  const auto file = hdf5::new_file();
  put_array(file, "texts", text_type(8), {4, 3});
  put_array(file, "bytes", H5T_STD_U8LE, {4, 3});
  put_array(file, "list", H5T_IEEE_F64LE, {4});
  put_array(file, "cube", H5T_IEEE_F64LE, {4, 3, 2});
  for (const char* name : {"texts", "bytes", "list", "cube"})
    EXPECT_THROW(hdf5::read_batch(file, name), StoreError) << name;
  for (const char* name : {"texts", "bytes", "cube"})
    EXPECT_THROW(hdf5::read_list(file, name), StoreError) << name;
  for (const char* name : {"texts", "bytes", "list"})
    EXPECT_THROW(hdf5::read_cube(file, name), StoreError) << name;
  const hdf5::Handle other(
      H5Tenum_create(H5T_STD_U8LE), H5Tclose, "make a type");
  const std::uint8_t zero = 0;
  H5Tenum_insert(other, "success", &zero);
  put_array(file, "others", other, {4});
  EXPECT_THROW(hdf5::read_codes(file, "others"), StoreError);
  EXPECT_THROW(hdf5::read_codes(file, "list"), StoreError);
}

TEST(Hdf5, NothingIsMadeForArraysThatAreNotThere) {
  const auto file = hdf5::new_file();
  const hsize_t huge = hsize_t{1} << 36;
  put_array(file, "never written", H5T_IEEE_F64LE, {4, 3});
  put_array(file, "huge", H5T_IEEE_F64LE, {huge, 3});
  for (const char* name : {"never written", "huge"})
    EXPECT_EQ(message_of<StoreError>([&] { hdf5::read_batch(file, name); }),
              fmt::format("array {} is incomplete", name));
  put_array(file, "long", H5T_IEEE_F64LE, {huge});
  EXPECT_THROW(hdf5::read_list(file, "long"), StoreError);
}

}  // namespace
}  // namespace physinv
