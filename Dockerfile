# docker build -t physinv-bench .
# docker run --rm -v "$PWD/results:/physinv-bench/results" physinv-bench --filter=billiards
FROM debian:12
RUN apt-get update && apt-get -y --no-install-recommends install git
WORKDIR /physinv-bench
COPY . .
# Installs what apt-packages.txt names and builds the program.
RUN ./bench --version
ENTRYPOINT ["./bench"]
