"""The jobs that gate changes, as .github/workflows and docs/gate.md have them,
run step by step in shallow clones: green on an unchanged program, red on a
planted change with every step run, green again once the change is declared.

The program over the fake experiment stands for the project: a launcher builds
nothing, plants the defect that its checkout names, and gives the clock a fake
case and few seconds."""

import os
import re
import shutil
import sys
import tempfile

import yaml

from services import GitHub, git, gitlab, revision, run_script, shallow_clone

BENCH, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
FAILED = []

LAUNCHER = f"""#!/usr/bin/env bash
here=$(cd "$(dirname "${{BASH_SOURCE[0]}}")" && pwd)
tree=$here/build/release
mkdir -p "$tree"
cat >"$tree/physinv-bench" <<END
#!/usr/bin/env bash
PHYSINV_FAKE_PLANT='$(cat "$here/plant")' \\
  PHYSINV_FAKE_PACE_MS=$(cat "$here/pace") exec {BENCH} "\\$@"
END
chmod +x "$tree/physinv-bench"
arguments=()
for a; do
  case $a in
    --filter=jpo* | --filter=hig*) arguments+=(--filter=descend) ;;
    --budget=*) arguments+=(--budget="$((2 + 10 * $(cat "$here/pace")))") ;;
    *) arguments+=("$a") ;;
  esac
done
exec "$tree/physinv-bench" "${{arguments[@]}}"
"""


def check(condition, what):
    print("ok  " if condition else "FAIL", what, flush=True)
    if not condition:
        FAILED.append(what)


class Project:
    """A repository of two commits, the second with a change."""

    def __init__(self, d):
        self.d, self.remote = d, os.path.join(d, "remote")
        tools = os.path.join(d, "tools")
        for path in (self.remote, tools, os.path.join(d, "published")):
            os.makedirs(path)
        self.env = {k: v for k, v in os.environ.items()
                    if not k.startswith(("GITHUB", "GIT_", "CI"))}
        self.env.update(HOME=d, PATH=tools + ":" + os.environ["PATH"],
                        PHYSINV_COUNT="nowhere",
                        PHYSINV_PUBLISHED_DIR=os.path.join(d, "published"))
        self.put(os.path.join(tools, "apt-get"), "#!/bin/sh\n")
        git("init", "-q", "-b", "main", cwd=self.remote)
        self.put(os.path.join(self.remote, "bench"), LAUNCHER)
        self.put(os.path.join(self.remote, ".gitignore"), "build\nresults\n")
        os.makedirs(os.path.join(self.remote, "reports", "baselines"))
        self.write("", "0")
        self.call("--profile=smoke", "--trace")
        self.call("baseline", "results/smoke")
        self.base = self.commit("base")

    def put(self, path, text):
        with open(path, "w") as f:
            f.write(text)
        os.chmod(path, 0o755)

    def write(self, plant, pace):
        self.put(os.path.join(self.remote, "plant"), plant)
        self.put(os.path.join(self.remote, "pace"), pace)

    def call(self, *args):
        code, text = run_script("./bench " + " ".join(args), self.remote,
                                self.env)
        assert code == 0, text

    def commit(self, message):
        git("add", "-A", cwd=self.remote)
        git("commit", "-q", "--allow-empty", "-m", message, cwd=self.remote)
        return revision(self.remote)

    def changed(self, plant="", pace="0", declared=False):
        """A commit on the base."""
        git("checkout", "-q", "-B", "change", self.base, cwd=self.remote)
        self.write(plant, pace)
        if declared:
            self.call("gate", "--baseline=reports/baselines/smoke.txt",
                      "--update")
        return self.commit("change")

    def workspace(self, name):
        path = os.path.join(self.d, name)
        shutil.rmtree(path, ignore_errors=True)
        return path


def workflow(name):
    with open(os.path.join(SOURCE, ".github", "workflows", name)) as f:
        return yaml.safe_load(f)


def page_job():
    with open(os.path.join(SOURCE, "docs", "gate.md")) as f:
        snippets = re.findall(r"^```yaml\n(.*?)^```$", f.read(), re.M | re.S)
    assert len(snippets) == 1
    return yaml.safe_load(snippets[0])["gate"]


def on_gitlab(project, head, labels=""):
    path = os.path.join(project.workspace("gitlab"), "clone")
    shutil.rmtree(os.path.join(project.d, "gitlab"), ignore_errors=True)
    shallow_clone(project.remote, head, path)
    code, _ = run_script(f"git cat-file -e {project.base}", path, project.env)
    check(code != 0, "the clone does not have the base")
    env = {**project.env, "CI_MERGE_REQUEST_DIFF_BASE_SHA": project.base}
    if labels:
        env["CI_MERGE_REQUEST_LABELS"] = labels
    return gitlab(page_job(), path, env), path


def on_github(project, head, labels=""):
    job = GitHub(workflow("pull-request.yml"), project.remote, project.env, {
        "head": head, "github.event.pull_request.base.sha": project.base,
        "join(github.event.pull_request.labels.*.name, ',')": labels})
    path = project.workspace("github")
    return job.run("gate", path), path


def requests(project):
    more = "more work"
    for name, job in (("GitLab", on_gitlab), ("GitHub", on_github)):
        for what, change, labels, green in (
                ("an unchanged program", {}, "", True),
                ("a planted change", {"plant": more}, "", False),
                ("a planted change, slower declared", {"plant": more},
                 "slower", False),
                ("the change with its baseline renewed",
                 {"plant": more, "declared": True}, "", True),
                ("a slowdown", {"pace": "5"}, "other", False),
                ("a slowdown that is declared", {"pace": "5"},
                 "other,slower", True)):
            result, path = job(project, project.changed(**change), labels)
            check(result.green == green,
                  f"{name}: {what} is {'green' if green else 'red'}: "
                  f"{result.codes}")
            if result.green != green:
                print(result.output)
            found = [os.path.exists(os.path.join(path, f + ".json"))
                     for f in ("kept", "moved", "times")]
            check(all(found), f"{name}: {what}: every step has run {found}")
            check(("vjp 40 -> 44" in result.output) == ("plant" in change),
                  f"{name}: {what}: what moves is said")


def nights(project):
    """The night after a change says so, the one after that holds the new."""
    job = GitHub(workflow("ci.yml"), project.remote, project.env, {})
    night = 0

    def run(what, green, says="", doubt=None, **change):
        nonlocal night
        night += 1
        job.values.update({"head": project.changed(**change),
                           "github.run_id": night, "github.run_attempt": 1})
        job.env = {**project.env,
                   **({"PHYSINV_FAKE_DOUBT": "1"} if doubt else {})}
        result = job.run("campaign", project.workspace("night"))
        check(result.green == green and says in result.output,
              f"night {night}, {what}: {result.codes}")
        if result.green != green:
            print(result.output)
        check(len(job.cache) == night, f"night {night} is kept")
        return result

    run("the first", True)
    run("nothing changed", True, "same")
    run("a change", False, "vjp", plant="more work")
    run("the change stays", True, "same", plant="more work")
    both = run("a claim fails and a change", False, "other bits",
               doubt=True, plant="ulp in a constant")
    check(sum(c != 0 for c in both.codes) == 2, "neither hides the other")


def caches():
    """One of a single action is not kept after a red job."""
    used = [step.get("uses") for job in workflow("ci.yml")["jobs"].values()
            for step in job["steps"]]
    check("actions/cache@v4" not in used, f"caches are kept: {used}")


with tempfile.TemporaryDirectory() as directory:
    made = Project(directory)
    requests(made)
    nights(made)
    caches()
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
