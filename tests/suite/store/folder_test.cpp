// What is not a file of ours is neither followed nor waited for nor replaced.
#include "suite/store/folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <set>
#include <thread>

#include "tests/suite/store/store_testing.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;

void make_socket(const fs::path& path) {
  sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
  path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  const FileDescriptor fd(socket(AF_UNIX, SOCK_STREAM, 0));
  ASSERT_EQ(bind(fd.get(),
                 reinterpret_cast<const sockaddr*>(&address),
                 sizeof(address)),
            0);
}

class FolderTest : public testing::Test {
 protected:
  FolderTest() {
    fs::create_directory(out_ / "store");
    write_file(out_ / "precious", "kept");
    folder_ = Folder(out_ / "store");
  }
  std::string outside() { return read_file(out_ / "precious"); }
  std::size_t count() { return folder_.names().size() - 2; }

  TemporaryDirectory out_;
  Folder folder_;
};

TEST_F(FolderTest, KeepsWhatIsWritten) {
  folder_.write("a", "old");
  folder_.write("a", "new");
  EXPECT_EQ(folder_.read("a", 3), "new");
  EXPECT_EQ(folder_.make("b").make("c").path(), out_ / "store" / "b" / "c");
  EXPECT_FALSE(folder_.find("c"));
  folder_.remove("a"), folder_.remove("a");
  EXPECT_FALSE(folder_.has("a"));
  EXPECT_EQ(count(), 1U);
}

TEST_F(FolderTest, FilesOfAGroupAreReplacedTogether) {
  folder_.write("a", "old");
  for (const std::string bytes : {"new", "newer"}) {
    FileGroup group(folder_);
    for (const char* name : {"a", "b", "c"}) group.add(name, name + bytes);
    EXPECT_NE(folder_.read("a", 9), "a" + bytes);
    group.put_in_place();
    for (const std::string name : {"a", "b", "c"})
      EXPECT_EQ(folder_.read(name, 9), name + bytes);
  }
  EXPECT_EQ(count(), 3U);
}

TEST_F(FolderTest, OfAGroupThatIsGivenUpNothingIsLeft) {
  folder_.write("a", "old");
  fs::create_symlink(out_ / "precious", out_ / "store" / "link");
  {
    FileGroup group(folder_);
    group.add("a", "new"), group.add("b", "new");
    EXPECT_THROW(group.add("link", "new"), StoreError);
  }
  EXPECT_EQ(folder_.read("a", 9), "old");
  EXPECT_EQ(outside(), "kept");
  EXPECT_EQ(count(), 2U);
}

TEST_F(FolderTest, NamesLeadNowhereElse) {
  for (const std::string name :
       {"../precious", "b/../../precious", "", ".", ".."}) {
    EXPECT_THROW(folder_.read(name, 10), StoreError) << name;
    EXPECT_THROW(folder_.write(name, "x"), StoreError) << name;
    EXPECT_THROW(folder_.remove(name), StoreError) << name;
    EXPECT_THROW(folder_.make(name), StoreError) << name;
  }
  EXPECT_EQ(outside(), "kept");
}

TEST_F(FolderTest, OtherThanFilesAreNamedAndLeftAlone) {
  const auto at = [&](const char* name) { return out_ / "store" / name; };
  fs::create_symlink("../precious", at("link"));
  fs::create_symlink("nowhere", at("dangling"));
  ASSERT_EQ(mkfifo(at("fifo").c_str(), 0600), 0);
  make_socket(at("socket"));
  fs::create_directory(at("directory"));
  const std::vector<std::pair<std::string, std::string>> kinds = {
      {"link", "it is a link"},
      {"dangling", "it is a link"},
      {"fifo", "it is a FIFO"},
      {"socket", "it is a socket"},
      {"directory", "it is a directory"}};
  for (const auto& [name, says] : kinds) {
    const auto message = [&](auto&& body) {
      return message_of<StoreError>(body);
    };
    EXPECT_TRUE(contains(message([&] { folder_.read(name, 10); }), says));
    EXPECT_TRUE(contains(message([&] { folder_.write(name, "x"); }), says));
    EXPECT_TRUE(contains(message([&] { folder_.remove(name); }), says));
    EXPECT_TRUE(contains(
        message([&] { folder_.open(name, O_RDWR | O_CREAT, "lock"); }), says));
    EXPECT_FALSE(folder_.create(name, "x"));
    if (name == "directory") continue;
    EXPECT_TRUE(contains(message([&] { folder_.make(name); }), says));
    EXPECT_TRUE(
        contains(message([&] { read_file(at("fifo")); }), "it is a FIFO"));
  }
  EXPECT_EQ(count(), kinds.size());
  EXPECT_EQ(outside(), "kept");
}

TEST_F(FolderTest, LargerFilesThanStatedAreNotRead) {
  write_file(out_ / "store" / "large", "");
  fs::resize_file(out_ / "store" / "large", std::uintmax_t{8} << 30);
  const auto says = "it has 8589934592 bytes, the limit is 536870912";
  EXPECT_TRUE(contains(
      message_of<StoreError>([&] { folder_.read("large", kLargestData); }),
      says));
  EXPECT_THROW(read_file(out_ / "store" / "large"), StoreError);
}

TEST_F(FolderTest, LeftoversAreOursByNameAndKind) {
  const std::string ours = ".physinv-0123456789abcdef";
  const std::vector<std::string> users = {"a.tmp",
                                          ".physinv-0123456789abcde.tmp",
                                          ".physinv-0123456789abcdeg.tmp",
                                          ours + ".tmp.tmp",
                                          "x" + ours + ".tmp"};
  for (const auto& name : users) write_file(out_ / "store" / name, "");
  fs::create_directory(out_ / "store" / ".physinv-00000000000000aa.tmp");
  fs::create_symlink("../precious",
                     out_ / "store" / ".physinv-00000000000000bb.tmp");
  write_file(out_ / "store" / (ours + ".tmp"), "");
  folder_.remove_leftovers();
  EXPECT_EQ(count(), users.size() + 2);
  EXPECT_FALSE(folder_.has(ours + ".tmp"));
  EXPECT_EQ(outside(), "kept");
}

TEST_F(FolderTest, WritersOfOneFileDoNotDisturbEachOther) {
  std::vector<std::thread> writers;
  std::set<std::string> texts;
  for (char c = 'a'; c < 'i'; ++c) texts.insert(std::string(100000, c));
  for (const auto& text : texts)
    writers.emplace_back([&] {
      for (int k = 0; k < 20; ++k) folder_.write("page", text);
    });
  for (auto& writer : writers) writer.join();
  EXPECT_TRUE(texts.contains(folder_.read("page", kLargestText)));
  EXPECT_EQ(count(), 1U);
}

TEST_F(FolderTest, RemovesOnlyWhatItHasRead) {
  folder_.write("a", "mine");
  EXPECT_FALSE(folder_.remove_if("a", "yours"));
  EXPECT_EQ(folder_.read("a", 10), "mine");
  EXPECT_TRUE(folder_.remove_if("a", "mine"));
  EXPECT_FALSE(folder_.remove_if("a", "mine"));
  EXPECT_EQ(count(), 0U);
}

/// Outputs that a user names.
TEST_F(FolderTest, WritesIntoWhatIsNoRegularFile) {
  const fs::path fifo = out_ / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_THROW(write_atomically(fifo, "unread"), StoreError) << "nobody reads";
  const FileDescriptor reader(open(fifo.c_str(), O_RDONLY | O_NONBLOCK));
  write_atomically(fifo, "text");
  char text[8] = {};
  EXPECT_EQ(read(reader.get(), text, sizeof(text)), 4);
  EXPECT_EQ(std::string(text), "text");
  EXPECT_TRUE(fs::is_fifo(fifo));
  write_atomically("/dev/null", "text");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  make_socket(out_ / "socket");
  EXPECT_TRUE(contains(
      message_of<StoreError>([&] { write_atomically(out_ / "socket", ""); }),
      "it is a socket"));
  EXPECT_THROW(write_atomically(out_ / "store", ""), StoreError);
}

TEST_F(FolderTest, LinksOfUsersAreFollowedAndStay) {
  fs::create_symlink("precious", out_ / "link");
  fs::create_symlink("link", out_ / "second");
  write_atomically(out_ / "second", "new");
  EXPECT_EQ(outside(), "new");
  EXPECT_TRUE(fs::is_symlink(out_ / "link"));
  fs::create_symlink("to come", out_ / "dangling");
  write_atomically(out_ / "dangling", "came");
  EXPECT_EQ(read_file(out_ / "to come"), "came");
  fs::create_symlink("round", out_ / "round");
  EXPECT_THROW(write_atomically(out_ / "round", ""), StoreError);
}

/// /dev/stdout of a program whose output goes into a file: what was printed
/// before stays.
TEST_F(FolderTest, DescriptorsOfThisProcessGoOnWhereTheyAre) {
  const FileDescriptor fd(
      open((out_ / "output").c_str(), O_WRONLY | O_CREAT, 0600));
  write_all(fd, "before ", out_ / "output");
  const auto own = "/dev/fd/" + std::to_string(fd.get());
  fs::create_symlink(own, out_ / "stdout");
  write_atomically(own, "there ");
  write_atomically(out_ / "stdout", "again ");
  write_all(fd, "after", out_ / "output");
  EXPECT_EQ(read_file(out_ / "output"), "before there again after");
}

TEST_F(FolderTest, AppendsToWhatOthersWrite) {
  append_to(out_ / "precious", " too");
  append_to(out_ / "new", "made");
  EXPECT_EQ(outside(), "kept too");
  EXPECT_EQ(read_file(out_ / "new"), "made");
}

}  // namespace
}  // namespace physinv
