// Two texts have the same substance exactly if the compiler reads the same.
#include "cmake/tokens.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace physinv::source {
namespace {

bool same(const std::string& a, const std::string& b) {
  return substance(tokens_of(a)) == substance(tokens_of(b));
}

TEST(Tokens, CommentsAndWhiteSpaceAreNone) {
  for (const auto& [a, b] :
       std::initializer_list<std::pair<const char*, const char*>>{
           {"int a=1;", "int a = 1 ;  // one"},
           {"int a;", "int/**/a;"},
           {"int a;", "/*/ int b; */ int\n\n  a\t;\n"},
           {"f(a, \"//\");", "f( a,\n \"//\" ); // \"\n"},
           {"#include \"a.h\"\nint b;",
            "  # include /* * */ \"a.h\" // c\nint b;"},
           {"#define A(x) (x+1)\n", "#define A( x ) \\\n  ( x + 1 )\n"},
           {"a\n#if B\nc\n#endif\n", "a\n  #if B  // d\n    c\n  #endif"},
           {"x = a < b;", "x = a<b;"}})
    EXPECT_TRUE(same(a, b)) << a << '\n' << b;
}

TEST(Tokens, EverythingElseCounts) {
  for (const auto& [a, b] :
       std::initializer_list<std::pair<const char*, const char*>>{
           {"a+ +b", "a++b"},
           {"a - -b", "a--b"},
           {"int ab;", "int a b;"},
           {"x < y", "x << y"},
           {"a = 1.5;", "a = 1.50;"},
           {"a = 1e-3;", "a = 1e - 3;"},
           {"a = 1'000;", "a = 1000;"},
           {"f(\"a b\");", "f(\"a  b\");"},
           {"f(\"a // b\");", "f(\"a\");"},
           {"f('\"', a);", "f('\"', b);"},
           {"f(\"\\\"\", a);", "f(\"\\\"\", b);"},
           {"f(R\"(a // b)\");", "f(R\"(a // c)\");"},
           {"f(R\"x(a)\"  )x\");", "f(R\"x(a)\" )x\");"},
           {"f(\"a\"sv);", "f(\"a\" sv);"},
           {"f(u8\"a\");", "f(u8 \"a\");"},
           {"#define A (1)\n", "#define A(1)\n"},
           {"#define A\nb", "#define A b"},
           {"#if A\n#endif\nb", "#if A\nb\n#endif"}})
    EXPECT_FALSE(same(a, b)) << a << '\n' << b;
}

TEST(Tokens, BrokenTextsEnd) {
  for (const char* text : {"\"",
                           "'",
                           "R\"",
                           "R\"(",
                           "/*",
                           "/",
                           "#",
                           "\\",
                           "1e+",
                           "#define",
                           "u8",
                           "f(\"\\",
                           "# /*"})
    EXPECT_NO_THROW(tokens_of(text)) << text;
}

TEST(Tokens, IncludesAreThoseOfTheProject) {
  EXPECT_EQ(includes(tokens_of("#include <vector>\n"
                               "#include \"suite/core/rng.h\"\n"
                               "// #include \"no.h\"\n"
                               "# include\"b.h\" // c\n"
                               "const char* a = \"#include \\\"d.h\\\"\";\n")),
            "suite/core/rng.h b.h ");
}

}  // namespace
}  // namespace physinv::source
