(* dz/dt is continuously differentiable in (v, z) for the laws that claim it. *)
From Coq Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
From Stribeck Require Import Laws Motion Power Terms Continuous Passive.
Open Scope R_scope.

Definition C1_1 (h : R -> R) : Prop :=
  exists d, (forall x, is_derive h x (d x)) /\ forall x, continuous (T := R_UniformSpace) (U := R_UniformSpace) d x.
(* both partial derivatives exist everywhere, and are continuous in both arguments together *)
Definition C1_2 (h : R -> R -> R) : Prop :=
  continuous_2 (U := R_UniformSpace) h /\
  exists hv hz, (forall v z, is_derive (fun v => h v z) v (hv v z)) /\ (forall v z, is_derive (h v) z (hz v z)) /\
    continuous_2 (U := R_UniformSpace) hv /\ continuous_2 (U := R_UniformSpace) hz.

(* --- rules --- *)
Lemma s_ext h k : (forall v z, h v z = k v z) -> C1_2 h -> C1_2 k.
Proof.
  intros E (C & hv & hz & Dv & Dz & Cv & Cz). split; [apply (c_ext h); assumption|]. exists hv, hz.
  split; [|split; [|split; assumption]]; intros v z.
  - apply (is_derive_ext (fun v => h v z)); [intros; apply E|apply Dv].
  - apply (is_derive_ext (h v)); [intros; apply E|apply Dz].
Qed.
Lemma s_v : C1_2 (fun v _ => v).
Proof.
  split; [apply (c_fst (U := R_UniformSpace) (fun v : R => v)); intros; apply continuous_id|].
  exists (fun _ _ => 1), (fun _ _ => 0). split; [|split; [|split; apply c_const]]; intros v z; auto_derive; auto.
Qed.
Lemma s_z : C1_2 (fun _ z => z).
Proof.
  split; [apply c_snd|].
  exists (fun _ _ => 0), (fun _ _ => 1). split; [|split; [|split; apply c_const]]; intros v z; auto_derive; auto.
Qed.
Lemma s_const c : C1_2 (fun _ _ => c).
Proof.
  split; [apply c_const|].
  exists (fun _ _ => 0), (fun _ _ => 0). split; [|split; [|split; apply c_const]]; intros v z; auto_derive; auto.
Qed.
Lemma s_plus h k : C1_2 h -> C1_2 k -> C1_2 (fun v z => h v z + k v z).
Proof.
  intros (C & hv & hz & Dv & Dz & Cv & Cz) (C' & kv & kz & Dv' & Dz' & Cv' & Cz'). split; [apply c_plus; assumption|].
  exists (fun v z => hv v z + kv v z), (fun v z => hz v z + kz v z).
  split; [|split; [|split; apply c_plus; assumption]]; intros v z.
  - apply (is_derive_plus (fun v => h v z) (fun v => k v z)); auto.
  - apply (is_derive_plus (h v) (k v)); auto.
Qed.
Lemma s_minus h k : C1_2 h -> C1_2 k -> C1_2 (fun v z => h v z - k v z).
Proof.
  intros (C & hv & hz & Dv & Dz & Cv & Cz) (C' & kv & kz & Dv' & Dz' & Cv' & Cz'). split; [apply c_minus; assumption|].
  exists (fun v z => hv v z - kv v z), (fun v z => hz v z - kz v z).
  split; [|split; [|split; apply c_minus; assumption]]; intros v z.
  - apply (is_derive_minus (fun v => h v z) (fun v => k v z)); auto.
  - apply (is_derive_minus (h v) (k v)); auto.
Qed.
Lemma s_mult h k : C1_2 h -> C1_2 k -> C1_2 (fun v z => h v z * k v z).
Proof.
  intros (C & hv & hz & Dv & Dz & Cv & Cz) (C' & kv & kz & Dv' & Dz' & Cv' & Cz'). split; [apply c_mult; assumption|].
  exists (fun v z => hv v z * k v z + h v z * kv v z), (fun v z => hz v z * k v z + h v z * kz v z).
  split; [|split; [|split; apply c_plus; apply c_mult; assumption]]; intros v z.
  - apply (is_derive_mult (fun v => h v z) (fun v => k v z)); auto. intros; apply Rmult_comm.
  - apply (is_derive_mult (h v) (k v)); auto. intros; apply Rmult_comm.
Qed.
Lemma s_comp phi h : C1_1 phi -> C1_2 h -> C1_2 (fun v z => phi (h v z)).
Proof.
  intros (d & D & Cd) (C & hv & hz & Dv & Dz & Cv & Cz). split.
  - apply (c_comp phi); [|exact C]. intros x. apply (is_derive_continuous _ _ _ (D x)).
  - exists (fun v z => hv v z * d (h v z)), (fun v z => hz v z * d (h v z)).
    assert (Cc : continuous_2 (U := R_UniformSpace) (fun v z => d (h v z))) by (apply (c_comp d); assumption).
    split; [|split; [|split; apply c_mult; assumption]]; intros v z.
    + apply (is_derive_comp phi (fun v => h v z)); auto.
    + apply (is_derive_comp phi (h v)); auto.
Qed.
Lemma s_inv h : (forall v z, h v z <> 0) -> C1_2 h -> C1_2 (fun v z => / h v z).
Proof.
  intros N (C & hv & hz & Dv & Dz & Cv & Cz).
  assert (Ci : continuous_2 (U := R_UniformSpace) (fun v z => / h v z)).
  { apply (c_ext (fun v z => 1 / h v z)); [intros; unfold Rdiv; ring|]. apply c_div; auto. apply c_const. }
  split; [exact Ci|]. exists (fun v z => - (hv v z * (/ h v z * / h v z))), (fun v z => - (hz v z * (/ h v z * / h v z))).
  split; [|split; [|split; apply c_opp; apply c_mult; auto; apply c_mult; assumption]]; intros v z.
  - evar_last; [apply (is_derive_inv (fun v => h v z) v (hv v z)); auto|]. simpl. field. apply N.
  - evar_last; [apply (is_derive_inv (h v) z (hz v z)); auto|]. simpl. field. apply N.
Qed.
Lemma s_div h k : (forall v z, k v z <> 0) -> C1_2 h -> C1_2 k -> C1_2 (fun v z => h v z / k v z).
Proof. intros N H K. apply (s_mult h (fun v z => / k v z)); [exact H|]. apply s_inv; assumption. Qed.

Lemma C1_of phi d : (forall x, is_derive phi x (d x)) ->
  (forall x, ex_derive d x) -> C1_1 phi.
Proof. intros D E. exists d. split; [exact D|]. intros x. apply (@ex_derive_continuous R_AbsRing R_NormedModule). apply E. Qed.

Lemma C1_exp : C1_1 exp.
Proof. apply (C1_of exp exp); intros x; [apply is_derive_exp|eexists; apply is_derive_exp]. Qed.
Lemma C1_atan : C1_1 atan.
Proof.
  apply (C1_of atan (fun x => / (1 + x * x))); intros x; assert (1 + x * x <> 0) by (pose proof (Rle_0_sqr x) as Q; unfold Rsqr in Q; lra).
  - auto_derive; [exact I|]. field. simpl. lra.
  - auto_derive. exact H.
Qed.
Lemma C1_sin : C1_1 sin.
Proof. apply (C1_of sin cos); intros x; [apply is_derive_sin|eexists; apply is_derive_cos]. Qed.

Ltac smooth1 := match goal with
  | H : C1_2 ?f |- C1_2 ?f => exact H
  | |- C1_2 (fun v z => v) => apply s_v
  | |- C1_2 (fun v z => z) => apply s_z
  | |- C1_2 (fun v z => ?c) => apply (s_const c)
  | |- C1_2 (fun v z => @?h v z + @?k v z) => apply (s_plus h k)
  | |- C1_2 (fun v z => @?h v z - @?k v z) => apply (s_minus h k)
  | |- C1_2 (fun v z => @?h v z * @?k v z) => apply (s_mult h k)
  | |- C1_2 (fun v z => - @?h v z) => apply (s_ext (fun v z => 0 - h v z)); [intros; unfold Rminus; apply Rplus_0_l|apply (s_minus (fun _ _ => 0) h)]
  | |- C1_2 (fun v z => @?h v z / ?k) => apply (s_mult h (fun _ _ => / k))
  | |- C1_2 (fun v z => @?h v z / @?k v z) => apply (s_div h k)
  | |- C1_2 (fun v z => exp (@?h v z)) => apply (s_comp exp h C1_exp)
  | |- C1_2 (fun v z => atan (@?h v z)) => apply (s_comp atan h C1_atan)
  | |- C1_2 (fun v z => sin (@?h v z)) => apply (s_comp sin h C1_sin)
  end.
Ltac smooth := repeat smooth1.

(* --- two pieces that meet with value and slope --- *)
Section Glue.
Variables (c : R) (f1 f2 d1 d2 : R -> R).
Hypothesis D1 : forall x, is_derive f1 x (d1 x).
Hypothesis D2 : forall x, is_derive f2 x (d2 x).
Hypothesis C1 : forall x, continuous (T := R_UniformSpace) (U := R_UniformSpace) d1 x.
Hypothesis C2 : forall x, continuous (T := R_UniformSpace) (U := R_UniformSpace) d2 x.
Hypothesis E : f1 c = f2 c.
Hypothesis ED : d1 c = d2 c.

(* with min and max no case is left at the seam *)
Definition glued (x : R) : R := f1 (Rmin x c) + f2 (Rmax x c) - f2 c.
Definition glued_slope (x : R) : R := d1 (Rmin x c) + d2 (Rmax x c) - d2 c.

Lemma glued_low x : x <= c -> glued x = f1 x.
Proof. intros H. unfold glued. rewrite Rmin_left, Rmax_right by exact H. ring. Qed.
Lemma glued_high x : c <= x -> glued x = f2 x.
Proof. intros H. unfold glued. rewrite Rmin_right, Rmax_left by exact H. rewrite E. ring. Qed.

Lemma glued_derive x : is_derive glued x (glued_slope x).
Proof.
  unfold glued_slope. destruct (Rtotal_order x c) as [H | [-> | H]].
  - rewrite Rmin_left, Rmax_right by lra. replace (d1 x + d2 c - d2 c) with (d1 x) by ring.
    apply (is_derive_ext_loc f1); [|apply D1].
    apply (locally_interval _ x m_infty c); simpl; auto. intros y _ Hy. symmetry. apply glued_low. simpl in Hy. lra.
  - rewrite Rmin_left, Rmax_left by lra. replace (d1 c + d2 c - d2 c) with (d1 c) by ring.
    apply is_derive_Reals. intros eps He.
    pose proof (D1 c) as A1. pose proof (D2 c) as A2. rewrite <- ED in A2.
    apply is_derive_Reals in A1. apply is_derive_Reals in A2.
    destruct (A1 eps He) as [a1 K1]. destruct (A2 eps He) as [a2 K2].
    assert (Hm : 0 < Rmin a1 a2) by (apply Rmin_glb_lt; [apply a1|apply a2]).
    exists (mkposreal _ Hm). intros h Hh Hlt. simpl in Hlt.
    pose proof (Rmin_l a1 a2). pose proof (Rmin_r a1 a2).
    destruct (Rle_lt_dec 0 h) as [P | P].
    + rewrite (glued_high (c + h)), (glued_high c) by lra. apply K2; [exact Hh|lra].
    + rewrite (glued_low (c + h)), (glued_low c) by lra. apply K1; [exact Hh|lra].
  - rewrite Rmin_right, Rmax_left by lra. replace (d1 c + d2 x - d2 c) with (d2 x) by (rewrite ED; ring).
    apply (is_derive_ext_loc f2); [|apply D2].
    apply (locally_interval _ x c p_infty); simpl; auto. intros y Hy _. symmetry. apply glued_high. simpl in Hy. lra.
Qed.

Lemma C1_glued : C1_1 glued.
Proof.
  exists glued_slope. split; [exact glued_derive|]. intros x.
  assert (Cm : continuous (T := R_UniformSpace) (U := R_UniformSpace) (fun x => Rmin x c) x).
  { apply (continuous_ext (fun x => (x + c - Rabs (x - c)) * / 2)); [intros; symmetry; apply Rmin_is|].
    apply (@continuous_mult R_UniformSpace R_AbsRing (fun x => x + c - Rabs (x - c)) (fun _ => / 2)); [|apply continuous_const].
    apply (@continuous_minus R_UniformSpace R_AbsRing R_NormedModule (fun x => x + c) (fun x => Rabs (x - c))); [apply (@continuous_plus R_UniformSpace R_AbsRing R_NormedModule (fun x => x) (fun _ => c)); [apply continuous_id|apply continuous_const]|].
    apply (continuous_comp (fun x => x - c) Rabs); [|apply continuous_Rabs].
    apply (@continuous_minus R_UniformSpace R_AbsRing R_NormedModule (fun x => x) (fun _ => c)); [apply continuous_id|apply continuous_const]. }
  assert (CM : continuous (T := R_UniformSpace) (U := R_UniformSpace) (fun x => Rmax x c) x).
  { apply (continuous_ext (fun x => (x + c + Rabs (x - c)) * / 2)); [intros; symmetry; apply Rmax_is|].
    apply (@continuous_mult R_UniformSpace R_AbsRing (fun x => x + c + Rabs (x - c)) (fun _ => / 2)); [|apply continuous_const].
    apply (@continuous_plus R_UniformSpace R_AbsRing R_NormedModule (fun x => x + c) (fun x => Rabs (x - c))); [apply (@continuous_plus R_UniformSpace R_AbsRing R_NormedModule (fun x => x) (fun _ => c)); [apply continuous_id|apply continuous_const]|].
    apply (continuous_comp (fun x => x - c) Rabs); [|apply continuous_Rabs].
    apply (@continuous_minus R_UniformSpace R_AbsRing R_NormedModule (fun x => x) (fun _ => c)); [apply continuous_id|apply continuous_const]. }
  unfold glued_slope. apply (continuous_minus (fun x => d1 (Rmin x c) + d2 (Rmax x c))); [|apply continuous_const].
  apply (continuous_plus (fun x => d1 (Rmin x c))).
  - apply (continuous_comp (fun x => Rmin x c) d1); [exact Cm|apply C1].
  - apply (continuous_comp (fun x => Rmax x c) d2); [exact CM|apply C2].
Qed.
End Glue.

Lemma C1_1_ext h k : (forall x, h x = k x) -> C1_1 h -> C1_1 k.
Proof. intros E (d & D & C). exists d. split; [|exact C]. intros x. apply (is_derive_ext h); auto. Qed.

(* --- the terms --- *)
(* Coquelicot's names of R are R. *)
Ltac real_eq := match goal with |- @eq _ ?a ?b => change (@eq R a b) end.

Lemma C1_glue_slopes c f1 f2 d1 d2 : (forall x, is_derive f1 x (d1 x)) -> (forall x, is_derive f2 x (d2 x)) ->
  (forall x, continuous (T := R_UniformSpace) (U := R_UniformSpace) d1 x) ->
  (forall x, continuous (T := R_UniformSpace) (U := R_UniformSpace) d2 x) -> f1 c = f2 c -> d1 c = d2 c ->
  exists d, (forall x, is_derive (fun x => if Rle_dec x c then f1 x else f2 x) x (d x)) /\
    (forall x, continuous (T := R_UniformSpace) (U := R_UniformSpace) d x) /\ (forall x, x <= c -> d x = d1 x).
Proof.
  intros D1 D2 K1 K2 E ED. destruct (C1_glued c f1 f2 d1 d2 D1 D2 K1 K2 E ED) as (_ & _ & _).
  assert (X : forall x, glued c f1 f2 x = if Rle_dec x c then f1 x else f2 x).
  { intros x. destruct (Rle_dec x c); [apply glued_low; assumption|apply glued_high; auto; lra]. }
  exists (glued_slope c d1 d2). split; [|split].
  - intros x. apply (is_derive_ext (glued c f1 f2)); [exact X|]. apply glued_derive; assumption.
  - destruct (C1_glued c f1 f2 d1 d2 D1 D2 K1 K2 E ED) as (d & Dd & Cd). intros x.
    apply (continuous_ext d); [|apply Cd]. intros y. rewrite <- (is_derive_unique _ _ _ (Dd y)).
    apply is_derive_unique. apply glued_derive; assumption.
  - intros x Hx. unfold glued_slope. rewrite Rmin_left, Rmax_right by exact Hx. unfold Rminus. rewrite Rplus_assoc, Rplus_opp_r. apply Rplus_0_r.
Qed.

(* A function that is f0 up to c0, f1 up to c1, and f2 from there. *)
Lemma C1_three c0 c1 f0 f1 f2 d0 d1 d2 : c0 <= c1 ->
  (forall x, is_derive f0 x (d0 x)) -> (forall x, is_derive f1 x (d1 x)) -> (forall x, is_derive f2 x (d2 x)) ->
  (forall x, ex_derive d0 x) -> (forall x, ex_derive d1 x) -> (forall x, ex_derive d2 x) ->
  f0 c0 = f1 c0 -> d0 c0 = d1 c0 -> f1 c1 = f2 c1 -> d1 c1 = d2 c1 ->
  C1_1 (fun x => if Rle_dec x c0 then f0 x else if Rle_dec x c1 then f1 x else f2 x).
Proof.
  intros Hc D0 D1 D2 K0 K1 K2 E0 S0 E1 S1.
  assert (Cc : forall d, (forall x, ex_derive d x) -> forall x, continuous (T := R_UniformSpace) (U := R_UniformSpace) d x).
  { intros d K x. apply (@ex_derive_continuous R_AbsRing R_NormedModule). apply K. }
  destruct (C1_glue_slopes c1 f1 f2 d1 d2 D1 D2 (Cc _ K1) (Cc _ K2) E1 S1) as (e & De & Ce & Ee).
  destruct (C1_glue_slopes c0 f0 (fun x => if Rle_dec x c1 then f1 x else f2 x) d0 e D0 De (Cc _ K0) Ce) as (d & Dd & Cd & _).
  - destruct (Rle_dec c0 c1); [exact E0|lra].
  - rewrite Ee by exact Hc. exact S0.
  - exists d. split; assumption.
Qed.

Lemma C1_m_sqrt p : 0 < k_v p -> C1_1 (m_sqrt p).
Proof.
  intros Hk. assert (C : 0 < 1 / (k_v p * k_v p)) by (apply Rdiv_lt_0_compat; nra).
  assert (P : forall x, 0 < x * x + 1 / (k_v p * k_v p)) by (intros x; pose proof (Rle_0_sqr x) as Q; unfold Rsqr in Q; lra).
  apply (C1_1_ext (fun v => sqrt (v * v + 1 / (k_v p * k_v p)))); [intros v; symmetry; apply m_sqrt_is; exact Hk|].
  set (c := 1 / (k_v p * k_v p)) in *.
  apply (C1_of (fun v => sqrt (v * v + c)) (fun v => v / sqrt (v * v + c))); intros x; specialize (P x);
    assert (0 < sqrt (x * x + c)) by (apply sqrt_lt_R0; exact P).
  - auto_derive; [exact P|]. field. lra.
  - auto_derive. split; [exact P|]. split; [lra|exact I].
Qed.

Lemma C1_m_compact p : 0 < k_v p -> C1_1 (m_compact p).
Proof.
  intros Hk. set (k := k_v p) in *. assert (Ik : 0 < / k) by (apply Rinv_0_lt_compat; exact Hk).
  apply (C1_1_ext (fun v => if Rle_dec v (- / k) then - v else if Rle_dec v (/ k)
    then (3 / k + 6 * k * (v * v) - k * (k * k) * (v * v * (v * v))) / 8 else v)).
  - intros v. rewrite m_compact_is by exact Hk. fold k.
    assert (K1 : forall r, k * r < 1 <-> r < / k).
    { intros r. split; intros H.
      - apply Rmult_lt_reg_l with k; [exact Hk|]. rewrite Rinv_r; lra.
      - apply Rmult_lt_compat_l with (r := k) in H; [|exact Hk]. rewrite Rinv_r in H; lra. }
    destruct (Rlt_dec (k * Rabs v) 1) as [L | L]; [apply K1 in L|assert (L' : / k <= Rabs v) by (apply Rnot_lt_le; intros N; apply L, K1, N)].
    + apply Rabs_def2 in L. destruct (Rle_dec v (- / k)); [lra|]. destruct (Rle_dec v (/ k)); [reflexivity|lra].
    + destruct (Rle_dec v (- / k)) as [A | A]; [rewrite Rabs_left; lra|].
      destruct (Rle_dec v (/ k)) as [B | B]; [|rewrite Rabs_pos_eq; lra].
      assert (V : v = / k).
      { unfold Rabs in L'. destruct (Rcase_abs v); lra. }
      rewrite V, Rabs_pos_eq by lra. field. lra.
  - apply (C1_three (- / k) (/ k) (fun v => - v) (fun v => (3 / k + 6 * k * (v * v) - k * (k * k) * (v * v * (v * v))) / 8)
      (fun v => v) (fun _ => - 1) (fun v => (12 * k * v - 4 * (k * (k * k)) * (v * (v * v))) / 8) (fun _ => 1)); try lra;
      try (intros x; auto_derive; [exact I|field; lra]); try (intros x; auto_derive; exact I); real_eq; field; lra.
Qed.

Lemma C1_smoothstep : C1_1 smoothstep.
Proof.
  apply (C1_1_ext (fun x => if Rle_dec x 0 then 0 else if Rle_dec x 1 then x * (x * x) * (10 - 15 * x + 6 * (x * x)) else 1)).
  - intros x. destruct (Rle_dec x 0); [symmetry; apply smoothstep_low; assumption|].
    destruct (Rle_dec x 1); [|symmetry; apply smoothstep_high; lra]. unfold smoothstep. rewrite clip01_mid by lra. reflexivity.
  - apply (C1_three 0 1 (fun _ => 0) (fun x => x * (x * x) * (10 - 15 * x + 6 * (x * x))) (fun _ => 1) (fun _ => 0)
      (fun x => 30 * ((x * (1 - x)) * (x * (1 - x)))) (fun _ => 0)); try lra; try (real_eq; ring);
      try (intros x; auto_derive; [exact I|ring]); intros x; auto_derive; exact I.
Qed.

Lemma C1_sine_step : C1_1 sine_step.
Proof.
  apply (C1_1_ext (fun x => if Rle_dec x 0 then 0 else if Rle_dec x 1 then 1 / 2 + 1 / 2 * sin (PI * (x - 1 / 2)) else 1)).
  - intros x. destruct (Rle_dec x 0); [symmetry; apply sine_step_low; assumption|].
    destruct (Rle_dec x 1); [|symmetry; apply sine_step_high; lra]. unfold sine_step. rewrite clip01_mid by lra. reflexivity.
  - assert (A : PI * (0 - 1 / 2) = - (PI / 2)) by field. assert (B : PI * (1 - 1 / 2) = PI / 2) by field.
    apply (C1_three 0 1 (fun _ => 0) (fun x => 1 / 2 + 1 / 2 * sin (PI * (x - 1 / 2))) (fun _ => 1) (fun _ => 0)
      (fun x => 1 / 2 * (PI * cos (PI * (x - 1 / 2)))) (fun _ => 0)); try lra;
      try (intros x; auto_derive; [exact I|field]); try (intros x; auto_derive; exact I).
    + intros x. auto_derive; [exact I|]. match goal with |- context [cos ?u] => replace u with (PI * (x - 1 / 2)) by (simpl; field) end.
      real_eq. simpl. field.
    + rewrite A, sin_neg, sin_PI2. lra.
    + rewrite A, cos_neg, cos_PI2. real_eq. ring.
    + rewrite B, sin_PI2. lra.
    + rewrite B, cos_PI2. real_eq. ring.
Qed.

Section Terms.
Variable p : constants.
Hypothesis Hs0 : 0 < sigma_0 p.
Hypothesis HFc : 0 < F_c p.
Hypothesis HF : F_c p <= F_s p.

Lemma s_g : C1_2 (fun v _ => g p v).
Proof. unfold g. smooth. Qed.
Lemma g_nonzero v : g p v <> 0.
Proof. apply Rgt_not_eq, Rlt_gt, g_pos; assumption. Qed.
Lemma s_S_0 : C1_2 (fun v _ => S_0 p v).
Proof. unfold S_0. smooth. Qed.
Lemma s_m_atan : C1_2 (fun v _ => m_atan p v).
Proof. unfold m_atan. pose proof s_S_0. smooth. Qed.
Lemma s_m_sqrt : 0 < k_v p -> C1_2 (fun v _ => m_sqrt p v).
Proof. intros Hk. apply (s_comp (m_sqrt p) (fun v _ => v)); [apply C1_m_sqrt; exact Hk|apply s_v]. Qed.
Lemma s_m_compact : 0 < k_v p -> C1_2 (fun v _ => m_compact p v).
Proof. intros Hk. apply (s_comp (m_compact p) (fun v _ => v)); [apply C1_m_compact; exact Hk|apply s_v]. Qed.

Hypothesis Hb : 0 < z_ba p.
Hypothesis Hba : z_ba p * sigma_0 p < F_c p.

(* A step of |z| is the sum of one of z and one of -z, as z_ba > 0 keeps it 0 around z = 0. *)
Lemma s_step (step : R -> R) : C1_1 step -> (forall x, x <= 0 -> step x = 0) -> C1_2 (fun v z => step (yielded p v z)).
Proof.
  intros Hs H0. assert (N : forall v : R, g p v - z_ba p <> 0).
  { intros v. pose proof (z_ba_below p v Hs0 HF Hba). lra. }
  apply (s_ext (fun v z => step ((z - z_ba p) / (g p v - z_ba p)) + step ((- z - z_ba p) / (g p v - z_ba p)))).
  - intros v z. unfold yielded. pose proof (z_ba_below p v Hs0 HF Hba) as B.
    assert (I : 0 < / (g p v - z_ba p)) by (apply Rinv_0_lt_compat; lra).
    destruct (Rle_lt_dec 0 z) as [Z | Z].
    + rewrite Rabs_pos_eq by exact Z. rewrite (H0 ((- z - z_ba p) / (g p v - z_ba p))); [ring|]. unfold Rdiv. nra.
    + rewrite Rabs_left by exact Z. rewrite (H0 ((z - z_ba p) / (g p v - z_ba p))); [ring|]. unfold Rdiv. nra.
  - pose proof s_g as G.
    assert (G' : C1_2 (fun v _ => g p v - z_ba p)) by smooth.
    apply s_plus; apply (s_comp step); auto; apply s_div; auto; smooth.
Qed.

Lemma s_a : C1_2 (a p).
Proof.
  apply (s_ext (fun v z => smoothstep (yielded p v z))); [intros; symmetry; apply a_is|].
  apply s_step; [exact C1_smoothstep|exact smoothstep_low].
Qed.
Lemma s_alpha_0 : C1_2 (alpha_0 p).
Proof.
  apply (s_ext (fun v z => sine_step (yielded p v z))).
  - intros v z. symmetry. apply alpha_0_is, z_ba_below; assumption.
  - apply s_step; [exact C1_sine_step|exact sine_step_low].
Qed.
End Terms.

(* --- the laws: dz/dt, and with it F --- *)
Theorem lugre_arctan_smooth p : lugre_arctan.allowed p -> C1_2 (lugre_arctan.dz_dt p) /\ C1_2 (lugre_arctan.friction p).
Proof.
  intros H. unfold lugre_arctan.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_S_0 p) as Term.
  assert (S : C1_2 (lugre_arctan.dz_dt p)).
  { unfold lugre_arctan.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold lugre_arctan.friction. smooth.
Qed.
Theorem lugre_sobczyk_smooth p : lugre_sobczyk.allowed p -> C1_2 (lugre_sobczyk.dz_dt p) /\ C1_2 (lugre_sobczyk.friction p).
Proof.
  intros H. unfold lugre_sobczyk.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_S_0 p) as Term.
  assert (S : C1_2 (lugre_sobczyk.dz_dt p)).
  { unfold lugre_sobczyk.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold lugre_sobczyk.friction. smooth.
Qed.
Theorem lugre_majorant_smooth p : lugre_majorant.allowed p -> C1_2 (lugre_majorant.dz_dt p) /\ C1_2 (lugre_majorant.friction p).
Proof.
  intros H. unfold lugre_majorant.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_m_atan p) as Term.
  assert (S : C1_2 (lugre_majorant.dz_dt p)).
  { unfold lugre_majorant.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold lugre_majorant.friction. smooth.
Qed.
Theorem lugre_majorant_sqrt_smooth p : lugre_majorant_sqrt.allowed p -> C1_2 (lugre_majorant_sqrt.dz_dt p) /\ C1_2 (lugre_majorant_sqrt.friction p).
Proof.
  intros H. unfold lugre_majorant_sqrt.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_m_sqrt p ltac:(assumption)) as Term.
  assert (S : C1_2 (lugre_majorant_sqrt.dz_dt p)).
  { unfold lugre_majorant_sqrt.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold lugre_majorant_sqrt.friction. smooth.
Qed.
Theorem lugre_majorant_compact_smooth p : lugre_majorant_compact.allowed p -> C1_2 (lugre_majorant_compact.dz_dt p) /\ C1_2 (lugre_majorant_compact.friction p).
Proof.
  intros H. unfold lugre_majorant_compact.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_m_compact p ltac:(assumption)) as Term.
  assert (S : C1_2 (lugre_majorant_compact.dz_dt p)).
  { unfold lugre_majorant_compact.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold lugre_majorant_compact.friction. smooth.
Qed.
Theorem elastoplastic_sobczyk_smooth p : elastoplastic_sobczyk.allowed p -> C1_2 (elastoplastic_sobczyk.dz_dt p) /\ C1_2 (elastoplastic_sobczyk.friction p).
Proof.
  intros H. unfold elastoplastic_sobczyk.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_S_0 p) as Term.
  pose proof (s_alpha_0 p ltac:(assumption) ltac:(assumption) ltac:(assumption) ltac:(assumption)) as Share.
  assert (S : C1_2 (elastoplastic_sobczyk.dz_dt p)).
  { unfold elastoplastic_sobczyk.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold elastoplastic_sobczyk.friction. smooth.
Qed.
Theorem elastoplastic_majorant_smooth p : elastoplastic_majorant.allowed p -> C1_2 (elastoplastic_majorant.dz_dt p) /\ C1_2 (elastoplastic_majorant.friction p).
Proof.
  intros H. unfold elastoplastic_majorant.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_m_atan p) as Term.
  pose proof (s_a p ltac:(assumption) ltac:(assumption) ltac:(assumption) ltac:(assumption)) as Share.
  assert (S : C1_2 (elastoplastic_majorant.dz_dt p)).
  { unfold elastoplastic_majorant.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold elastoplastic_majorant.friction. smooth.
Qed.
Theorem elastoplastic_majorant_sqrt_smooth p : elastoplastic_majorant_sqrt.allowed p -> C1_2 (elastoplastic_majorant_sqrt.dz_dt p) /\ C1_2 (elastoplastic_majorant_sqrt.friction p).
Proof.
  intros H. unfold elastoplastic_majorant_sqrt.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_m_sqrt p ltac:(assumption)) as Term.
  pose proof (s_a p ltac:(assumption) ltac:(assumption) ltac:(assumption) ltac:(assumption)) as Share.
  assert (S : C1_2 (elastoplastic_majorant_sqrt.dz_dt p)).
  { unfold elastoplastic_majorant_sqrt.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold elastoplastic_majorant_sqrt.friction. smooth.
Qed.
Theorem elastoplastic_majorant_compact_smooth p : elastoplastic_majorant_compact.allowed p -> C1_2 (elastoplastic_majorant_compact.dz_dt p) /\ C1_2 (elastoplastic_majorant_compact.friction p).
Proof.
  intros H. unfold elastoplastic_majorant_compact.allowed in H. repeat match goal with K : _ /\ _ |- _ => destruct K end.
  pose proof (s_g p) as Level. pose proof (s_m_compact p ltac:(assumption)) as Term.
  pose proof (s_a p ltac:(assumption) ltac:(assumption) ltac:(assumption) ltac:(assumption)) as Share.
  assert (S : C1_2 (elastoplastic_majorant_compact.dz_dt p)).
  { unfold elastoplastic_majorant_compact.dz_dt. smooth; intros; apply g_nonzero; assumption. }
  split; [exact S|]. unfold elastoplastic_majorant_compact.friction. smooth.
Qed.

(* lugre is not: at v = 0 the slopes of |v| z/g by v differ on the two sides. *)
Theorem lugre_not_smooth p z : lugre.allowed p -> z <> 0 -> ~ ex_derive (fun v => lugre.dz_dt p v z) 0.
Proof.
  intros (H0 & _ & _ & Hc & _ & _ & HF) Hz [l D].
  assert (G : forall v, g p v <> 0) by (intros v; apply g_nonzero; assumption).
  assert (Dg : ex_derive (g p) 0).
  { destruct (s_g p) as (_ & hv & _ & Dv & _). eexists. apply (Dv 0 0). }
  assert (K : ex_derive Rabs 0).
  { apply (ex_derive_ext (fun v => (v - lugre.dz_dt p v z) * (g p v * / z))).
    - intros v. unfold lugre.dz_dt. real_eq. field. split; [exact Hz|apply G].
    - destruct Dg as [dg Dg]. eexists.
      apply (@is_derive_mult R_AbsRing (fun v => v - lugre.dz_dt p v z) (fun v => g p v * / z) 0 (1 - l) (dg * / z)).
      + apply (@is_derive_minus R_AbsRing R_NormedModule (fun v => v) (fun v => lugre.dz_dt p v z) 0 1 l); [|exact D].
        apply (@is_derive_id R_AbsRing).
      + apply (is_derive_ext (fun v => / z * g p v)); [intros v; apply Rmult_comm|].
        evar_last; [apply (is_derive_scal (g p) 0 (/ z) dg Dg)|]. apply Rmult_comm.
      + intros; apply Rmult_comm. }
  destruct K as [k K]. apply is_derive_Reals in K.
  destruct (K (1 / 2)) as [d Hd]; [lra|]. pose proof (cond_pos d) as P.
  assert (A : Rabs ((Rabs (0 + d / 2) - Rabs 0) / (d / 2) - k) < 1 / 2) by (apply Hd; [lra|rewrite Rabs_pos_eq; lra]).
  assert (B : Rabs ((Rabs (0 + - (d / 2)) - Rabs 0) / - (d / 2) - k) < 1 / 2) by (apply Hd; [lra|rewrite Rabs_left; lra]).
  rewrite Rabs_R0 in A, B. rewrite (Rabs_pos_eq (0 + d / 2)) in A by lra. rewrite (Rabs_left (0 + - (d / 2))) in B by lra.
  replace ((0 + d / 2 - 0) / (d / 2)) with 1 in A by (field; lra).
  replace ((- (0 + - (d / 2)) - 0) / - (d / 2)) with (- 1) in B by (field; lra).
  apply Rabs_def2 in A. apply Rabs_def2 in B. lra.
Qed.
