"""As much of two CI services as the project's jobs use: steps under bash -e in
shallow clones of a repository on this machine, with conditions, caches and
uploads. What is not known here is an error."""

import glob
import os
import re
import shutil
import subprocess

BASH = ["bash", "--noprofile", "--norc", "-eo", "pipefail"]


def git(*args, cwd):
    subprocess.run(["git", "-c", "user.name=ci", "-c", "user.email=ci@ci",
                    *args], cwd=cwd, check=True, capture_output=True)


def revision(cwd, name="HEAD"):
    return subprocess.run(["git", "rev-parse", name], cwd=cwd, check=True,
                          text=True, capture_output=True).stdout.strip()


def shallow_clone(remote, commit, path):
    """One commit, as the services fetch it."""
    os.makedirs(path, exist_ok=True)
    git("init", "-q", cwd=path)
    git("remote", "add", "origin", "file://" + remote, cwd=path)
    git("fetch", "-q", "--depth=1", "origin", commit, cwd=path)
    git("checkout", "-q", "FETCH_HEAD", cwd=path)


class Steps:
    """Exit codes, in order, and whether all of it is green."""

    def __init__(self):
        self.codes, self.green, self.output = [], True, ""


def run_script(text, cwd, env):
    p = subprocess.run([*BASH, "-c", text], cwd=cwd, text=True, env=env,
                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                       timeout=300)
    return p.returncode, p.stdout


def gitlab(job, cwd, env):
    """The lines of `script` are one script; the first that fails ends it."""
    unknown = set(job) - {"image", "rules", "script", "artifacts"}
    assert not unknown, unknown
    result = Steps()
    code, result.output = run_script("\n".join(job["script"]), cwd, env)
    result.codes, result.green = [code], code == 0
    return result


class GitHub:
    """`remote` is the repository, `values` are what expressions stand for."""

    def __init__(self, workflow, remote, env, values):
        self.shell = workflow.get("defaults", {}).get("run", {}).get("shell")
        self.workflow, self.remote = workflow, remote
        self.env, self.values, self.cache = env, dict(values), {}

    def value(self, text):
        return re.sub(r"\$\{\{ (.*?) \}\}",
                      lambda m: str(self.values[m[1]]), str(text))

    def holds(self, condition, green, outcomes):
        terms = re.sub(r"^\$\{\{ (.*) \}\}$", r"\1", condition).split(" && ")
        return all(self.term(term, green, outcomes) for term in terms)

    def term(self, term, green, outcomes):
        if term in ("success()", "failure()"):
            return green == (term == "success()")
        if term in ("always()", "!cancelled()"):
            return True
        step, outcome = re.fullmatch(r"steps\.(\w+)\.outcome == '(\w+)'",
                                     term).groups()
        return outcomes.get(step) == outcome

    def use(self, action, given, cwd):
        given = {k: self.value(v) for k, v in given.items()}
        path = os.path.join(cwd, given.get("path", "."))
        if action == "actions/checkout@v4":
            shallow_clone(self.remote, given.get("ref", self.values["head"]),
                          path)
        elif action == "actions/cache/restore@v4":
            known = [k for k in self.cache if k == given["key"]
                     or k.startswith(given["restore-keys"])]
            if known:
                with open(path, "wb") as f:
                    f.write(self.cache[known[-1]])
        elif action == "actions/cache/save@v4":
            assert given["key"] not in self.cache, "a key is saved once"
            with open(path, "rb") as f:
                self.cache[given["key"]] = f.read()
        elif action == "actions/upload-artifact@v4":
            assert glob.glob(path), f"nothing to upload: {given['path']}"
        else:
            raise AssertionError(f"unknown action {action}")

    def run(self, name, cwd):
        """A job in a workspace of its own."""
        shutil.rmtree(cwd, ignore_errors=True)
        os.makedirs(cwd)
        job, result, outcomes = self.workflow["jobs"][name], Steps(), {}
        assert "container" not in job or self.shell == "bash", "sh, not bash"
        for step in job["steps"]:
            unknown = set(step) - {"name", "id", "if", "uses", "with", "run",
                                   "env", "continue-on-error"}
            assert not unknown, unknown
            if not self.holds(step.get("if", "success()"), result.green,
                              outcomes):
                continue
            code = 0
            if "uses" in step:
                self.use(step["uses"], step.get("with", {}), cwd)
            else:
                own = {k: self.value(v)
                       for k, v in step.get("env", {}).items()}
                code, text = run_script(self.value(step["run"]), cwd,
                                        {**self.env, **own})
                result.output += text
                result.codes.append(code)
            outcomes[step.get("id")] = "failure" if code else "success"
            if code and not step.get("continue-on-error", False):
                result.green = False
        return result
