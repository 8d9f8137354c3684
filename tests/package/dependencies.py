#!/usr/bin/env python3
"""Whether all library headers that the modules and the programs include come with what scripts/install_dependencies.sh
installs: on a machine that has more, a package that is missing there goes unnoticed.

Usage: dependencies.py BUILD   (built with Ninja, which knows the headers of each object)
"""
import re
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / 'scripts' / 'install_dependencies.sh'


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def headers_of(build):
    """The system's headers in the objects of our modules and programs: the tests and benchmarks may need more."""
    headers, is_ours = set(), False
    for line in output_of('ninja', '-C', build, '-t', 'deps').splitlines():
        if not line.startswith(' '):
            is_ours = line.startswith('CMakeFiles/')
        elif is_ours and line.strip().startswith('/usr/'):
            headers.add(str(Path(line.strip()).resolve()))
    return headers


def packages_that_have(files):
    """The package of each file."""
    packages = {}
    for line in output_of('dpkg', '--search', *sorted(files)).splitlines():
        owners, path = line.rsplit(': ', 1)
        packages[path] = owners.split(', ')[0].split(':')[0]
    return packages


def names_in(field):
    """Names of packages in a field of dpkg, without versions and architectures."""
    return re.findall(r'(?:^|[,|])\s*([a-z0-9][a-z0-9+.-]*)', field)


def with_dependencies(packages):
    """These packages and what they ask for, of what is installed."""
    providers = {}
    for line in output_of('dpkg-query', '--show', '--showformat=${Package}\t${Pre-Depends},${Depends}\t${Provides}\n').splitlines():
        name, needs, provides = line.split('\t')
        for provided in [name, *names_in(provides)]:
            providers.setdefault(provided, []).append((name, names_in(needs)))
    installed, left = set(), list(packages)
    while left:
        for name, needs in providers.get(left.pop(), []):
            if name not in installed:
                installed.add(name)
                left += needs
    return installed


def main():
    listed = re.search(r'^packages=\((.*?)^\)', SCRIPT.read_text(), re.DOTALL | re.MULTILINE).group(1).split()
    installed = with_dependencies(listed)
    packages = packages_that_have(headers_of(sys.argv[1]))
    missing = {path: package for path, package in packages.items() if package not in installed}
    for path, package in sorted(missing.items()):
        print(f'{SCRIPT.name} installs no package that asks for {package}: {path}')
    print(f'{len(packages)} headers, {len(set(packages.values()))} packages, {len(missing)} headers not installed')
    sys.exit(1 if missing or not packages else 0)


if __name__ == '__main__':
    main()
