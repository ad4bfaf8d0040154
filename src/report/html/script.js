// The page is complete without this script: it adds a search, opens the target of a link, and prints every check.
(function () {
  "use strict";
  var search = document.getElementById("search");
  var bodies = Array.prototype.slice.call(document.querySelectorAll("table.checks tbody"));
  function all() {
    var radio = document.getElementById("show-all");
    if (radio) { radio.checked = true; }
    if (search) { search.value = ""; }
    bodies.forEach(function (body) { body.hidden = false; });
    families();
  }
  function families() {
    document.querySelectorAll(".family").forEach(function (family) {
      family.hidden = !family.querySelector("tbody:not([hidden])");
    });
  }
  function look() {
    var word = search.value.trim().toLowerCase();
    bodies.forEach(function (body) {
      body.hidden = word !== "" && body.textContent.toLowerCase().indexOf(word) < 0;
    });
    families();
  }
  // A link may lead to a check that is currently hidden.
  function follow() {
    var target = location.hash.length > 1 && document.getElementById(location.hash.slice(1));
    if (target && target.closest("#checklist") && target.getClientRects().length === 0) {
      all();
      target.scrollIntoView();
    }
  }
  if (search) {
    search.parentElement.hidden = false;
    search.addEventListener("input", look);
  }
  window.addEventListener("hashchange", follow);
})();
